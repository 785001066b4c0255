# SPDX-License-Identifier: Apache-2.0
# What every target of this project has in common: language level and warnings.

# opms_target_defaults(<target>)
function(opms_target_defaults target)
    target_compile_features(${target} PRIVATE c_std_11 cxx_std_17)
    set_target_properties(${target} PROPERTIES C_EXTENSIONS OFF CXX_EXTENSIONS OFF)
    target_compile_options(${target} PRIVATE
        -Wall -Wextra -Wpedantic -Wshadow $<$<BOOL:${OPMS_WERROR}>:-Werror>)
endfunction()
