# wayfuse::wayfuse is libwayfuse with its C interface; wayfuse::sdk is everything in C++, static.
include(CMakeFindDependencyMacro)
find_dependency(Threads)
find_dependency(OpenSSL 3)
include(${CMAKE_CURRENT_LIST_DIR}/wayfuse-targets.cmake)
