// SPDX-License-Identifier: Apache-2.0
// A program of someone else, in C++17: opens a trigger box that nobody has and says why it cannot.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>

#include <opms/hid.h>
#include <opms/opms.h>

namespace
{

// Not "": a box that happens to be plugged in here is let alone.
constexpr const char *ID_OF_NO_BOX = "FFFFFFFFFFFFFFFF";

bool is_clear(opms_status_t status, const opms_error_t &error)
{
    return status == OPMS_ERR_DEVICE && std::strstr(error.message, ID_OF_NO_BOX) &&
           std::strstr(error.message, "is not plugged in");
}

} // namespace

int main()
{
    opms_box_options_t options;
    opms_box_options_init(&options);
    std::snprintf(options.unique_id, sizeof options.unique_id, "%s", ID_OF_NO_BOX);
    opms_box_t *box = nullptr;
    opms_error_t error{};
    const opms_status_t status = opms_box_open(&options, &box, &error);
    std::cout << "libopms " << opms_version() << ": " << error.message << '\n';
    if (!is_clear(status, error) || box) {
        std::cerr << "status " << status << ", not what docs/box.md promises\n";
        opms_box_close(box);
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
