/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * What GLib counts, frees or fails with, for C++. */
#ifndef OPMS_SOURCES_GLIB_POINTERS_HPP
#define OPMS_SOURCES_GLIB_POINTERS_HPP

#include <memory>
#include <string>

#include <glib-object.h>

namespace opms_host {

struct GObjectUnref {
    void operator()(gpointer object) const { g_object_unref(object); }
};
/** Holds one reference. */
template <typename Type> using GObjectPtr = std::unique_ptr<Type, GObjectUnref>;

struct GFree {
    void operator()(gpointer memory) const { g_free(memory); }
};
template <typename Type> using GMemory = std::unique_ptr<Type, GFree>;

/** Where a call puts its failure. */
class GFailure {
public:
    GFailure() = default;
    ~GFailure() { g_clear_error(&error_); }
    GFailure(const GFailure &) = delete;
    GFailure &operator=(const GFailure &) = delete;
    /** For the next call; what was there is forgotten. */
    GError **fresh()
    {
        g_clear_error(&error_);
        return &error_;
    }
    explicit operator bool() const { return error_ != nullptr; }
    std::string text() const { return error_ ? error_->message : ""; }

private:
    GError *error_ = nullptr;
};

}  // namespace opms_host
#endif
