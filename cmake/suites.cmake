# ctest runs this script when it starts, with `module` and its test program `program`. The script makes each suite of
# GoogleTest a test of ctest. The tests of a suite share a process and the programs that OpenGL's driver compiles in it,
# which takes a third less CPU time than a process for each test.
if(NOT EXISTS ${program})
  add_test(${module}_is_not_built ${program})
  return()
endif()
execute_process(COMMAND ${program} --gtest_list_tests OUTPUT_VARIABLE listed COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "\n[A-Za-z0-9_/]+\\." suites "\n${listed}")
foreach(suite ${suites})
  string(REGEX REPLACE "[\n.]" "" suite ${suite})
  add_test(${module}.${suite} ${program} --gtest_filter=${suite}.*)
  # A suite counts as skipped if none of its tests ran. ctest tests this expression before the exit code, so a failure
  # must not match it: the list of failed tests follows that of skipped ones. ./check names each skipped test.
  set_tests_properties(${module}.${suite} PROPERTIES TIMEOUT 1800
                       SKIP_REGULAR_EXPRESSION "PASSED  . 0 tests\\.\n(.  SKIPPED [^\n]*\n?)+$")
endforeach()
