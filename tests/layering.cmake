# Nobody includes what stands above: core < proto/messages < proto/formats < server. One includer per
# foreign library. Run: cmake -DROOT=<source dir> -P tests/layering.cmake

cmake_minimum_required(VERSION 3.25)

set(broken "")

# forbid(WHERE PATTERN WHY [ALLOWED...]): no file under WHERE may have an include that matches PATTERN,
# except the ALLOWED ones.
function(forbid where pattern why)
  file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/${where}/*.cpp ${ROOT}/${where}/*.h)
  set(allowed ${ARGN})
  foreach(file IN LISTS files)
    if(file IN_LIST allowed)
      continue()
    endif()
    file(STRINGS ${ROOT}/${file} hits REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"](${pattern})")
    foreach(hit IN LISTS hits)
      string(APPEND broken "${file}: ${hit}: ${why}\n")
    endforeach()
  endforeach()
  set(broken "${broken}" PARENT_SCOPE)
endfunction()

get_filename_component(ROOT ${ROOT} ABSOLUTE)
forbid(core "proto/|server/" "core knows no bytes, JSON, files or processes")
forbid(core "nlohmann/|httplib|sqlite3|draco/|meshoptimizer|tiny_gltf|fmt/|sys/|unistd|filesystem|fstream"
       "core links Eigen and OpenMesh and nothing else")
forbid(proto/messages "server/|proto/formats/" "messages stand below formats and server")
forbid(proto/formats "server/" "formats stand below the server")
forbid(server/os "proto/|server/fairway" "os stands below the programs")
forbid(server/fairwayd "proto/formats/|server/fairway/|server/fairway-submit/"
       "the service never decodes a mesh")
forbid(server/fairway "server/fairwayd/|server/fairway-submit/|httplib|sqlite3"
       "the tool knows no HTTP and no database")
forbid(server/fairway-submit "server/fairwayd/|server/fairway/|core/[^r]|sqlite3"
       "the batch client knows the API and no mesh")
forbid(server/fairway-submit "proto/formats/" "only URIs of side files are looked at"
       server/fairway-submit/scene_files.cpp)

# The rooms of the service, from the ground up: each may include itself, what stands before it, and no
# room after it.
set(above "telemetry;http;site;store;uploads;work;webhooks;api;operations;settings;commands")
while(above)
  list(POP_FRONT above room)
  if(above)
    list(JOIN above "/|server/fairwayd/" higher)
    forbid(server/fairwayd/${room} "server/fairwayd/${higher}/|server/fairwayd/service"
           "rooms of the service stand on each other")
  endif()
endwhile()
forbid(server/fairwayd/store "server/fairwayd/http/" "what is stored knows no HTTP")

# One includer per foreign library.
foreach(room core proto server)
  forbid(${room} "OpenMesh/" "only core/halfedge.cpp includes OpenMesh" core/halfedge.cpp)
  forbid(${room} "draco/" "only draco_decoder.cpp and draco_encoder.cpp include Draco"
         proto/formats/draco_decoder.cpp proto/formats/draco_encoder.cpp
         proto/formats/draco_library.h)
  forbid(${room} "proto/formats/draco_library.h" "it shows the library"
         proto/formats/draco_decoder.cpp proto/formats/draco_encoder.cpp)
  forbid(${room} "meshoptimizer" "only meshopt_decoder.cpp and meshopt_encoder.cpp include meshoptimizer"
         proto/formats/meshopt_decoder.cpp proto/formats/meshopt_encoder.cpp)
  forbid(${room} "tiny_gltf" "only proto/formats/fresh_gltf.cpp includes tinygltf"
         proto/formats/fresh_gltf.cpp)
  forbid(${room} "yaml-cpp" "only proto/embed.cpp, of the build, includes yaml-cpp" proto/embed.cpp)
  forbid(${room} "sqlite3" "only server/fairwayd/store/sqlite.cpp includes sqlite"
         server/fairwayd/store/sqlite.cpp)
  forbid(${room} "seccomp" "only server/os/sandbox.cpp includes libseccomp" server/os/sandbox.cpp)
  forbid(${room} "curl/" "only server/fairwayd/webhooks/webhook_client.cpp includes libcurl"
         server/fairwayd/webhooks/webhook_client.cpp)
  forbid(${room} "httplib" "only http_engine.cpp, health_command.cpp and http_session.cpp include httplib"
         server/fairwayd/http/http_engine.cpp server/fairwayd/commands/health_command.cpp
         server/fairway-submit/http_session.cpp)
endforeach()

if(broken)
  message(FATAL_ERROR "Layers are broken:\n${broken}")
endif()
message(STATUS "layers hold")
