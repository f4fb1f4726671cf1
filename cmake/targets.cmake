# sightline_library(NAME sources...): target sightline (NAME sightline) or sightline_NAME, with the alias sightline::NAME
# and the project's warnings. sightline_strict(TARGET): the warnings and the arithmetic alone, for programs.
function(sightline_strict target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  # Same bits on every machine: no contraction of a * b + c behind our back. Programs too, for what headers hold in line.
  target_compile_options(${target} PRIVATE -ffp-contract=off)
  # GCC 12 takes pairs of double -> float -> double for nothing and drops the rounding, once its straight-line vectoriser
  # has made vectors of two of them (the test View.EyeIsAFloat fails then).
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fno-tree-slp-vectorize>)
  if(PROJECT_IS_TOP_LEVEL)
    target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wconversion -Wshadow
      $<$<CXX_COMPILER_ID:GNU>:-Werror>)
    # Each compiler has its own taste: GCC decides. GCC 12 warns of its own std::string (bug 105651).
    target_compile_options(${target} PRIVATE $<$<AND:$<CXX_COMPILER_ID:GNU>,$<VERSION_LESS:$<CXX_COMPILER_VERSION>,13>>:-Wno-restrict>)
  endif()
  if(SIGHTLINE_SANITIZE)
    target_compile_options(${target} PUBLIC -fsanitize=${SIGHTLINE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    target_link_options(${target} PUBLIC -fsanitize=${SIGHTLINE_SANITIZE})
    # The added checks lead GCC's analysis of its own <regex> astray.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  endif()
endfunction()

function(sightline_library name)
  set(target sightline)
  if(NOT name STREQUAL sightline)
    set(target sightline_${name})
  endif()
  add_library(${target} ${ARGN})
  add_library(sightline::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:include>)
  sightline_strict(${target})
endfunction()

# Several sources of a target as one, where most of the time goes into the same headers: the tool compiles thrice as fast.
function(sightline_unity target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
endfunction()
