# Run by ctest as it starts, with `module` and `program`, a module's program of GoogleTest's: makes each suite a test
# of ctest's. Its tests share a process, and with it what OpenGL's driver compiles, which takes a third less of the CPU's
# time than a process for each test.
if(NOT EXISTS ${program})
  add_test(${module}_is_not_built ${program})
  return()
endif()
execute_process(COMMAND ${program} --gtest_list_tests OUTPUT_VARIABLE listed COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "\n[A-Za-z0-9_/]+\\." suites "\n${listed}")
foreach(suite ${suites})
  string(REGEX REPLACE "[\n.]" "" suite ${suite})
  add_test(${module}.${suite} ${program} --gtest_filter=${suite}.*)
  # Skipped is a suite of which nothing ran. ctest heeds this before the exit code, so a failure must not match: the list
  # of failed tests follows that of skipped ones. ./check names each test that was skipped.
  set_tests_properties(${module}.${suite} PROPERTIES TIMEOUT 1800
                       SKIP_REGULAR_EXPRESSION "PASSED  . 0 tests\\.\n(.  SKIPPED [^\n]*\n?)+$")
endforeach()
