/* SPDX-License-Identifier: Apache-2.0 */
/* dlopen() of a bare name would take the RUNPATH of whoever calls it, which under a sanitizer is
 * the sanitizer's: so the program's own is asked for. */
#include "program_module.hpp"

#include <cstddef>
#include <filesystem>
#include <vector>

#include <dlfcn.h>
#include <link.h>

namespace opms_host {

namespace {

std::string last_error()
{
    const char *const text = dlerror();
    return text ? text : "unknown";
}

/** Where the program looks for its shared libraries. */
std::vector<std::string> library_folders()
{
    std::vector<std::string> folders;
    void *const program = dlopen(nullptr, RTLD_LAZY);
    Dl_serinfo size = {};
    if (!program || dlinfo(program, RTLD_DI_SERINFOSIZE, &size) != 0) {
        return folders;
    }
    std::vector<std::max_align_t> room(size.dls_size / sizeof(std::max_align_t) + 1);
    auto *const info = reinterpret_cast<Dl_serinfo *>(room.data());
    info->dls_size = size.dls_size;
    info->dls_cnt = size.dls_cnt;
    if (dlinfo(program, RTLD_DI_SERINFO, info) == 0) {
        /* The array is declared with one element, but has dls_cnt. */
        const Dl_serpath *const paths = info->dls_serpath;
        for (unsigned int i = 0; i < info->dls_cnt; i++) {
            folders.emplace_back(paths[i].dls_name);
        }
    }
    return folders;
}

std::string find_module(const char *module)
{
    for (const std::string &folder : library_folders()) {
        const std::string path = folder + "/" + module;
        std::error_code ignored;
        if (!folder.empty() && std::filesystem::is_regular_file(path, ignored)) {
            return path;
        }
    }
    return std::string();
}

}  // namespace

void *program_module_symbol(const char *module, const char *symbol, std::string &error)
{
    const std::string path = find_module(module);
    if (path.empty()) {
        error = std::string("the program's part ") + module + " is not installed";
        return nullptr;
    }
    void *const loaded = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
    void *const found = loaded ? dlsym(loaded, symbol) : nullptr;
    if (!found) {
        error = std::string("the program's part ") + module + " cannot be loaded: " + last_error();
    }
    return found;
}

}  // namespace opms_host
