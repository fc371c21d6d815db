#find_package(wetcurl) : the target wetcurl::wetcurl, headers wetcurl.h(C) and wetcurl.hpp(C++).
include("${CMAKE_CURRENT_LIST_DIR}/wetcurl-targets.cmake")
