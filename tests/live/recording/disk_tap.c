/* SPDX-License-Identifier: Apache-2.0 */
/* The system is called by syscall(): by name, each function would find itself. Call and record are
 * made under one lock, so that the log has the order in which things happened. */
#define _GNU_SOURCE
#include "disk_tap.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

enum { KIND_MARK, KIND_CREATE, KIND_WRITE, KIND_SIZE, KIND_RENAME, KIND_REMOVE, KIND_FOLDER,
       KIND_SYNC };
enum { PATH_SIZE = 4096 };

typedef struct record {
    uint32_t kind, name_size, other_size, data_size;
    int64_t time_ns, offset, reserved;
} record_t;

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static int is_ready;
static int log_file = -1;
static char root[PATH_SIZE];  /* of what is logged; "" for nothing */
static char limited[PATH_SIZE]; /* of what is limited */
static long long bytes_left;
static int limit_error;

static void get_ready(void)
{
    if (is_ready) {
        return;
    }
    is_ready = 1;
    const char *folder = getenv("OPMS_DISK_ROOT");
    const char *path = getenv("OPMS_DISK_LOG");
    if (folder && path && strlen(folder) < sizeof root) {
        strcpy(root, folder);
        log_file = (int)syscall(SYS_openat, AT_FDCWD, path,
                                O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0644);
    }
}

static int is_below(const char *path, const char *folder)
{
    const size_t size = strlen(folder);
    return size > 0 && strncmp(path, folder, size) == 0 && (path[size] == '/' || !path[size]);
}

static void put(const void *bytes, size_t size)
{
    const char *next = bytes;
    while (size > 0) {
        const long some = syscall(SYS_write, log_file, next, size);
        if (some <= 0) {
            abort();
        }
        next += some;
        size -= (size_t)some;
    }
}

static void append(uint32_t kind, const char *name, const char *other, const void *data,
                   size_t size, int64_t offset)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    const record_t head = {kind, (uint32_t)strlen(name), (uint32_t)strlen(other), (uint32_t)size,
                           (int64_t)now.tv_sec * 1000000000 + now.tv_nsec, offset, 0};
    put(&head, sizeof head);
    put(name, head.name_size);
    put(other, head.other_size);
    put(data, size);
}

/** The path below which a name stands; relative to the root. NULL: not of interest. */
static const char *relative(const char *path)
{
    return log_file >= 0 && is_below(path, root) ? path + strlen(root) : NULL;
}

static int path_of(int file, char path[PATH_SIZE])
{
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const long size = syscall(SYS_readlinkat, AT_FDCWD, link, path, PATH_SIZE - 1);
    path[size > 0 ? size : 0] = '\0';
    return size > 0;
}

/** Shared memory beside the database: rebuilt after each start. */
static int is_scratch(const char *path)
{
    const size_t size = strlen(path);
    return size >= 4 && strcmp(path + size - 4, "-shm") == 0;
}

void disk_tap_mark(const char *line)
{
    pthread_mutex_lock(&lock);
    get_ready();
    if (log_file >= 0) {
        append(KIND_MARK, "", "", line, strlen(line), 0);
    }
    pthread_mutex_unlock(&lock);
}

void disk_tap_limit(const char *folder, long long bytes, int error)
{
    pthread_mutex_lock(&lock);
    snprintf(limited, sizeof limited, "%s", folder);
    bytes_left = bytes;
    limit_error = error;
    pthread_mutex_unlock(&lock);
}

void disk_tap_free(void)
{
    disk_tap_limit("", 0, 0);
}

/* --- the calls ------------------------------------------------------------------------------- */

static int tap_open(int folder, const char *path, int flags, mode_t mode)
{
    pthread_mutex_lock(&lock);
    get_ready();
    const int creates = flags & (O_CREAT | O_TRUNC);
    const int was_there = creates && syscall(SYS_faccessat, folder, path, F_OK) == 0;
    const int file = (int)syscall(SYS_openat, folder, path, flags, mode);
    const int error = errno;
    char full[PATH_SIZE];
    if (file >= 0 && creates && log_file >= 0 && path_of(file, full) && relative(full) &&
        !is_scratch(full)) {
        if (!was_there) {
            append(KIND_CREATE, relative(full), "", "", 0, 0);
        } else if (flags & O_TRUNC) {
            append(KIND_SIZE, relative(full), "", "", 0, 0);
        }
    }
    pthread_mutex_unlock(&lock);
    errno = error;
    return file;
}

static mode_t mode_of(int flags, va_list list)
{
    return flags & (O_CREAT | O_TMPFILE) ? va_arg(list, mode_t) : 0;
}

#define TAP_OPEN(name)                                                                            \
    int name(const char *path, int flags, ...)                                                    \
    {                                                                                             \
        va_list list;                                                                             \
        va_start(list, flags);                                                                    \
        const mode_t mode = mode_of(flags, list);                                                 \
        va_end(list);                                                                             \
        return tap_open(AT_FDCWD, path, flags, mode);                                             \
    }
TAP_OPEN(open)
TAP_OPEN(open64)

/** How much of a write there is room for; -1 where there is none. */
static ssize_t room_for(const char *path, size_t size)
{
    if (!is_below(path, limited)) {
        return (ssize_t)size;
    }
    if (bytes_left <= 0) {
        errno = limit_error;
        return -1;
    }
    const ssize_t room = bytes_left < (long long)size ? (ssize_t)bytes_left : (ssize_t)size;
    bytes_left -= room;
    return room;
}

/** @param offset  Negative: where the file stands. */
static ssize_t tap_write(int file, const void *data, size_t size, int64_t offset)
{
    pthread_mutex_lock(&lock);
    get_ready();
    char path[PATH_SIZE] = "";
    const int watched = (log_file >= 0 || limited[0]) && path_of(file, path);
    const ssize_t room = watched ? room_for(path, size) : (ssize_t)size;
    const int64_t at = offset < 0 ? syscall(SYS_lseek, file, 0L, SEEK_CUR) : offset;
    ssize_t done = -1;
    if (room >= 0) {
        done = offset < 0 ? syscall(SYS_write, file, data, (size_t)room)
                          : syscall(SYS_pwrite64, file, data, (size_t)room, offset);
    }
    const int error = errno;
    if (done > 0 && watched && relative(path) && !is_scratch(path)) {
        append(KIND_WRITE, relative(path), "", data, (size_t)done, at);
    }
    pthread_mutex_unlock(&lock);
    errno = error;
    return done;
}

ssize_t write(int file, const void *data, size_t size)
{
    return tap_write(file, data, size, -1);
}
ssize_t pwrite(int file, const void *data, size_t size, off_t offset)
{
    return tap_write(file, data, size, offset);
}
ssize_t pwrite64(int file, const void *data, size_t size, off64_t offset)
{
    return tap_write(file, data, size, offset);
}

static int tap_size(int file, int64_t size)
{
    pthread_mutex_lock(&lock);
    get_ready();
    char path[PATH_SIZE];
    const int result = (int)syscall(SYS_ftruncate, file, size);
    const int error = errno;
    if (result == 0 && log_file >= 0 && path_of(file, path) && relative(path) &&
        !is_scratch(path)) {
        append(KIND_SIZE, relative(path), "", "", 0, size);
    }
    pthread_mutex_unlock(&lock);
    errno = error;
    return result;
}

int ftruncate(int file, off_t size)
{
    return tap_size(file, size);
}
int ftruncate64(int file, off64_t size)
{
    return tap_size(file, size);
}

static int tap_sync(int file, long call)
{
    char path[PATH_SIZE] = "";
    pthread_mutex_lock(&lock);
    get_ready();
    const int result = (int)syscall(call, file);
    const int error = errno;
    if (result == 0 && log_file >= 0 && path_of(file, path) && relative(path)) {
        append(KIND_SYNC, relative(path), "", "", 0, 0);
    }
    pthread_mutex_unlock(&lock);
    errno = error;
    return result;
}

int fsync(int file)
{
    return tap_sync(file, SYS_fsync);
}
int fdatasync(int file)
{
    return tap_sync(file, SYS_fdatasync);
}

/** Calls by names that are absolute. */
static int tap_name(uint32_t kind, long call, const char *name, const char *other, long third)
{
    pthread_mutex_lock(&lock);
    get_ready();
    const int result = kind == KIND_RENAME
                           ? (int)syscall(call, AT_FDCWD, name, AT_FDCWD, other)
                           : (int)syscall(call, AT_FDCWD, name, third);
    const int error = errno;
    if (result == 0 && relative(name) && !is_scratch(name)) {
        append(kind, relative(name), other && relative(other) ? relative(other) : "", "", 0, 0);
    }
    pthread_mutex_unlock(&lock);
    errno = error;
    return result;
}

int rename(const char *from, const char *to)
{
    return tap_name(KIND_RENAME, SYS_renameat, from, to, 0);
}
int mkdir(const char *path, mode_t mode)
{
    return tap_name(KIND_FOLDER, SYS_mkdirat, path, NULL, (long)mode);
}
int unlink(const char *path)
{
    return tap_name(KIND_REMOVE, SYS_unlinkat, path, NULL, 0);
}
int rmdir(const char *path)
{
    return tap_name(KIND_REMOVE, SYS_unlinkat, path, NULL, AT_REMOVEDIR);
}
int remove(const char *path)
{
    struct stat status;
    const int is_folder = lstat(path, &status) == 0 && S_ISDIR(status.st_mode);
    return is_folder ? rmdir(path) : unlink(path);
}
