# Writes OUTPUT, a header with the commit that SOURCE is of; empty where that is not known. Run with every build, so that it
# is never an older one; a header that would say the same is left as it is.
cmake_minimum_required(VERSION 3.25)
set(commit "")
find_package(Git QUIET)
if(Git_FOUND)
  set(git ${GIT_EXECUTABLE} --no-optional-locks -C ${SOURCE})
  execute_process(COMMAND ${git} rev-parse --show-cdup
    OUTPUT_VARIABLE above OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed AND above STREQUAL "") # not within another repository
    execute_process(COMMAND ${git} rev-parse --short=12 HEAD
      OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    execute_process(COMMAND ${git} status --porcelain --untracked-files=no
      OUTPUT_VARIABLE changes ERROR_QUIET)
    if(NOT changes STREQUAL "")
      string(APPEND commit "+")
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#define EVOD_COMMIT \"${commit}\"\n" @ONLY)
