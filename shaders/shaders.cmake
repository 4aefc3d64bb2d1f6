# GLSL -> SPIR-V at build time, embedded into one library. A GLSL error stops the build with file and line.
file(GLOB_RECURSE shader_sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/shaders/*.comp ${CMAKE_SOURCE_DIR}/shaders/*.vert
     ${CMAKE_SOURCE_DIR}/shaders/*.frag)
find_program(GLSLANG glslangValidator REQUIRED)

set(spirv_dir ${CMAKE_BINARY_DIR}/spirv)
set(table ${spirv_dir}/table.cpp)
set(entries "")
set(includes "")
set(spirv_headers "")
foreach(source ${shader_sources})
  file(RELATIVE_PATH name ${CMAKE_SOURCE_DIR}/shaders ${source})
  string(MAKE_C_IDENTIFIER ${name} symbol)
  set(header ${spirv_dir}/${symbol}.h)
  add_custom_command(
    OUTPUT ${header}
    COMMAND ${GLSLANG} --quiet --target-env vulkan1.3 -I${CMAKE_SOURCE_DIR}/shaders -g --vn spirv_${symbol} -o ${header}
            --depfile ${header}.d ${source}
    DEPENDS ${source}
    DEPFILE ${header}.d
    COMMENT "GLSL ${name}"
    VERBATIM)
  list(APPEND spirv_headers ${header})
  string(APPEND includes "#include \"${symbol}.h\"\n")
  string(APPEND entries "    {\"${name}\", spirv_${symbol}, sizeof(spirv_${symbol}) / 4},\n")
endforeach()
file(CONFIGURE OUTPUT ${table} CONTENT "// Made by shaders/shaders.cmake.
#include <cstddef>
#include <cstdint>
#include \"gpu/spirv.h\"
${includes}
namespace alabaster::gpu {
const SpirvEntry spirv_table[] = {
${entries}    {nullptr, nullptr, 0}};
}
")
add_library(alabaster_spirv STATIC ${table} ${spirv_headers})
target_include_directories(alabaster_spirv PRIVATE ${spirv_dir} ${CMAKE_SOURCE_DIR}/engine)
