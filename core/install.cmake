# What others get of core: the library, its public headers, and what find_package and pkg-config ask for.
set(public_headers
  corner_table.h
  curvature.h
  denoise.h
  edge_topology.h
  execution.h
  features.h
  flow_kernels.h
  flow_options.h
  halfedge.h
  index.h
  mesh.h
  normals.h
  result.h
  shapes.h
  slice.h
  surface_geometry.h
  surface_measures.h
  surface_topology.h
  triangle_mesh.h
  weld.h)

# Included as <fairway/core/...>: a plain "core/..." might find a file of the stranger's own.
set(installed_headers "")
function(fairway_public_header from to)
  set(header ${CMAKE_CURRENT_BINARY_DIR}/include/fairway/${to})
  add_custom_command(OUTPUT ${header}
    COMMAND ${CMAKE_COMMAND} -DFROM=${CMAKE_CURRENT_SOURCE_DIR}/${from} -DTO=${header}
            -P ${CMAKE_CURRENT_SOURCE_DIR}/public_header.cmake
    DEPENDS ${from} public_header.cmake)
  list(APPEND installed_headers ${header})
  set(installed_headers ${installed_headers} PARENT_SCOPE)
endfunction()
fairway_public_header(fairway.h fairway.h)
foreach(header IN LISTS public_headers)
  fairway_public_header(${header} core/${header})
endforeach()
add_custom_target(public_headers ALL DEPENDS ${installed_headers})

add_library(fairway::core ALIAS core)
set_target_properties(core PROPERTIES OUTPUT_NAME fairway_core)
target_include_directories(core INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)

include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/fairway)
set(pkgconfig_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH prefix_from_pkgconfig /${pkgconfig_dir} /)
string(REGEX REPLACE "/$" "" prefix_from_pkgconfig "${prefix_from_pkgconfig}")
configure_package_config_file(fairwayConfig.cmake.in fairwayConfig.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(fairwayConfigVersion.cmake COMPATIBILITY SameMinorVersion)
configure_file(fairway.pc.in fairway.pc @ONLY)

install(TARGETS core EXPORT fairway ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/include/fairway/fairway.h
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/fairway)
list(TRANSFORM public_headers PREPEND ${CMAKE_CURRENT_BINARY_DIR}/include/fairway/core/)
install(FILES ${public_headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/fairway/core)
install(EXPORT fairway NAMESPACE fairway:: FILE fairwayTargets.cmake DESTINATION ${package_dir})
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/fairwayConfig.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/fairwayConfigVersion.cmake DESTINATION ${package_dir})
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/fairway.pc DESTINATION ${pkgconfig_dir})
