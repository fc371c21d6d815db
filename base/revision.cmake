# Writes OUTPUT, a header that names the revision of SOURCE, where it is not what it says already.
#   cmake -D SOURCE=... -D OUTPUT=... -D VERSION=... -D PRESET=... -D MARCH=... -P revision.cmake
# Outside of git the file REVISION names it, which a release's archive holds.
set(revision unknown)
find_program(git git)
if(git)
  execute_process(COMMAND ${git} -C ${SOURCE} rev-parse --short=12 HEAD
    OUTPUT_VARIABLE commit RESULT_VARIABLE failed OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT failed)
    set(revision ${commit})
    # Results and pages may be newer than the program.
    execute_process(COMMAND ${git} -C ${SOURCE} diff --quiet HEAD -- . :!results :!docs RESULT_VARIABLE changed ERROR_QUIET)
    if(changed)
      string(APPEND revision ", changed")
    endif()
  endif()
endif()
if(revision STREQUAL unknown AND EXISTS ${SOURCE}/REVISION)
  file(STRINGS ${SOURCE}/REVISION revision LIMIT_COUNT 1)
endif()
set(text "#define WETCURL_VERSION \"${VERSION}\"\n#define WETCURL_REVISION \"${revision}\"\n#define WETCURL_PRESET \"${PRESET}\"\n#define WETCURL_MARCH \"${MARCH}\"\n")
set(old "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} old)
endif()
if(NOT text STREQUAL old)
  file(WRITE ${OUTPUT} "${text}")
endif()
