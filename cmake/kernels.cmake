# rabiline_add_kernels(target SOURCES a.cpp b.cpp): compiles the sources once for each instruction set and adds the objects
# to the target; once per target. A source puts everything into namespace rabiline::RABILINE_ISA (src/core/lanes.hpp); the
# program chooses among isa_baseline, isa_avx2 and isa_avx512 with best_isa() (src/core/isa.hpp). Code that names the last
# two stands inside #if defined(__x86_64__): elsewhere there is only the baseline.
#
# -O3 in every build type but the sanitizers': without it a kernel is no kernel. -fno-math-errno lets sqrt of a negative number leave errno
# alone, so that it becomes an instruction where lanes.hpp has no intrinsic for it; no value depends on it. -ffp-contract
# is off through rabiline_options, and again here because the same bits everywhere depend on it.
function(rabiline_add_kernels target)
  cmake_parse_arguments(ARG "" "" "SOURCES" ${ARGN})
  set(isas baseline)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
    list(APPEND isas avx2 avx512)
  endif()
  set(lanes_of_baseline 2)
  set(lanes_of_avx2 4)
  set(lanes_of_avx512 8)
  set(flags_of_baseline "")
  set(flags_of_avx2 -mavx2 -mfma)
  set(flags_of_avx512 -mavx2 -mfma -mavx512f -mavx512dq -mavx512vl -mavx512bw -mprefer-vector-width=512)
  foreach(isa ${isas})
    set(objects ${target}_${isa})
    add_library(${objects} OBJECT ${ARG_SOURCES})
    target_link_libraries(${objects} PRIVATE rabiline_options)
    target_compile_definitions(${objects} PRIVATE RABILINE_ISA=isa_${isa} RABILINE_LANE_COUNT=${lanes_of_${isa}})
    target_compile_options(${objects} PRIVATE $<IF:$<BOOL:${RABILINE_SANITIZE}>,-O1,-O3> -ffp-contract=off -fno-math-errno ${flags_of_${isa}})
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:${objects}>)
    # Sources with a UNITY_GROUP are compiled together: what they include takes longer than the little that they hold.
    set_target_properties(${objects} PROPERTIES RABILINE_UNWATCHED ON UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    if(RABILINE_SANITIZE STREQUAL address AND NOT isa STREQUAL avx2)
      # Addresses alone. The widest and the narrowest lanes have the source of all.
      target_compile_options(${objects} PRIVATE -fsanitize=address ${by_calls})
    endif()
  endforeach()
endfunction()
