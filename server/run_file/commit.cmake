# Writes the header OUTPUT, which defines EVOD_COMMIT as the commit of the folder SOURCE, or as an empty text if the commit is
# unknown. Every build runs this script. It leaves the header untouched if its contents would not change.
cmake_minimum_required(VERSION 3.25)
set(commit "")
if(EXISTS ${SOURCE}/COMMIT) # the source archive of a release
  file(STRINGS ${SOURCE}/COMMIT commit LIMIT_COUNT 1)
endif()
find_package(Git QUIET)
if(Git_FOUND)
  set(git ${GIT_EXECUTABLE} --no-optional-locks -C ${SOURCE})
  execute_process(COMMAND ${git} rev-parse --show-cdup
    OUTPUT_VARIABLE above OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed AND above STREQUAL "") # SOURCE is the top folder of its repository
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
