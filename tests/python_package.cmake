# SPDX-License-Identifier: Apache-2.0
# The tests of the Python package, where the interpreter (Python3_EXECUTABLE) has it installed.
# `./run test` makes an environment that has.
execute_process(COMMAND ${Python3_EXECUTABLE} -c "import opms, pytest"
    RESULT_VARIABLE opms_python_missing OUTPUT_QUIET ERROR_QUIET)
if(opms_python_missing)
    message(STATUS "The Python package is not tested: ${Python3_EXECUTABLE} has no opms or pytest")
    return()
endif()

add_test(NAME python.package
    COMMAND Python3::Interpreter -B -m pytest -q -p no:cacheprovider
        ${PROJECT_SOURCE_DIR}/tests/python)
# The code in README.md runs as it stands, from the root.
add_test(NAME python.readme
    COMMAND Python3::Interpreter -B ${PROJECT_SOURCE_DIR}/tests/lint/run_readme.py python
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
add_test(NAME package.readme
    COMMAND Python3::Interpreter -B ${PROJECT_SOURCE_DIR}/tests/lint/run_readme.py c
        --prefix ${CMAKE_CURRENT_BINARY_DIR}/consumer/prefix)
set_tests_properties(package.readme PROPERTIES FIXTURES_REQUIRED package)
set_tests_properties(python.package python.readme package.readme PROPERTIES TIMEOUT 900)
