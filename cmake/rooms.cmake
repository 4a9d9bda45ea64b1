# Rooms, the one library made of them, the programs, and the registries that hold it all together.

set(GONIO_ROOMS "" CACHE INTERNAL "")
set(GONIO_THIRD_PARTY "" CACHE INTERNAL "")
set(GONIO_MODULES "" CACHE INTERNAL "")
set(GONIO_GENERATED ${CMAKE_BINARY_DIR}/generated)

# gonio_room(NAME THIRD_PARTY...): lib/NAME/**.cpp as an object library. Vendored and system headers are -isystem.
function(gonio_room name)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/lib/${name}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "_module\\.cpp$")
  gonio_in_units(sources lib ${name})
  set(GONIO_THIRD_PARTY ${GONIO_THIRD_PARTY} ${ARGN} CACHE INTERNAL "")
  if(NOT sources)
    return()
  endif()
  add_library(room_${name} OBJECT ${sources})
  target_include_directories(room_${name} PUBLIC ${CMAKE_SOURCE_DIR}/lib)
  target_compile_definitions(room_${name} PRIVATE GONIO_VERSION="${PROJECT_VERSION}")
  foreach(library IN LISTS ARGN)
    if(TARGET ${library})
      get_target_property(includes ${library} INTERFACE_INCLUDE_DIRECTORIES)
      if(includes)
        target_include_directories(room_${name} SYSTEM PRIVATE ${includes})
      endif()
    endif()
  endforeach()
  target_link_libraries(room_${name} PRIVATE ${ARGN})
  gonio_allow_units(room_${name})
  set(GONIO_ROOMS ${GONIO_ROOMS} room_${name} CACHE INTERNAL "")
endfunction()

# gonio_module(SOURCE THIRD_PARTY...): lib/SOURCE_module.cpp, a shared library that is loaded when it is first called
# (base/loaded_library.h), with libraries that would make the start of every program slow. It lies in lib/gonio of the
# build and of an installation.
function(gonio_module source)
  get_filename_component(name ${source} NAME)
  add_library(gonio_${name} MODULE ${CMAKE_SOURCE_DIR}/lib/${source}_module.cpp)
  set_target_properties(gonio_${name} PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET default
                        LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/gonio)
  target_include_directories(gonio_${name} PRIVATE ${CMAKE_SOURCE_DIR}/lib)
  target_link_libraries(gonio_${name} PRIVATE ${ARGN})
  if(NOT GONIO_SANITIZE AND NOT GONIO_FUZZ)
    target_link_options(gonio_${name} PRIVATE -Wl,-z,defs)  # nothing of it may wait for what a program happens to have
  endif()
  set(GONIO_MODULES ${GONIO_MODULES} gonio_${name} CACHE INTERNAL "")
endfunction()

# gonio_bindings(FOLDER TYPE HEADER NAMESPACE LIST INNER): lib/FOLDER/*.cpp, one file for each mechanism that a simulator
# has, in NAMESPACE::INNER, as the registry NAMESPACE::LIST(); its source is appended to `bindings`.
macro(gonio_bindings folder type header namespace list inner)
  file(GLOB binding_files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/lib/${folder}/*.cpp)
  string(REPLACE "/" "_" binding_source ${folder})
  gonio_registry(${GONIO_GENERATED}/${binding_source}.cpp ${type} ${header}
    "std::span<const ${namespace}::${type}* const> ${namespace}::${list}()" ${namespace}::${inner} ${binding_files})
  list(APPEND bindings ${GONIO_GENERATED}/${binding_source}.cpp)
endmacro()

# One static library of all rooms plus the generated registries; the programs take from it what they use.
function(gonio_finish_library)
  set(bindings "")
  file(GLOB mechanism_files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/lib/*/mechanisms/*.cpp)
  file(GLOB surface_files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/lib/surface/models/*.cpp)
  file(GLOB law_files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/lib/surface/laws/*.cpp)
  file(GLOB light_files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/lib/light/models/*.cpp)
  file(GLOB domain_files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/lib/explain/domains/*.cpp)
  file(GLOB exchange_files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/lib/scene/exchange/formats/*.cpp)
  gonio_registry(${GONIO_GENERATED}/mechanisms.cpp Mechanism mechanism/mechanism.h
    "std::span<const gonio::mechanism::Mechanism* const> gonio::mechanism::all_mechanisms()" gonio::mechanism
    ${mechanism_files})
  gonio_registry(${GONIO_GENERATED}/surfaces.cpp Model surface/surface.h
    "std::span<const gonio::surface::Model* const> gonio::surface::all_models()" gonio::surface ${surface_files})
  gonio_registry(${GONIO_GENERATED}/laws.cpp Law surface/law.h
    "std::span<const gonio::surface::Law* const> gonio::surface::all_laws()" gonio::surface ${law_files})
  gonio_registry(${GONIO_GENERATED}/lights.cpp Model light/light.h
    "std::span<const gonio::light::Model* const> gonio::light::all_models()" gonio::light ${light_files})
  file(GLOB microstructure_files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/lib/relief/microstructures/*.cpp)
  gonio_registry(${GONIO_GENERATED}/microstructures.cpp Microstructure relief/microstructure.h
    "std::span<const gonio::relief::Microstructure* const> gonio::relief::all_microstructures()"
    gonio::relief::microstructures ${microstructure_files})
  file(GLOB form_files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/lib/glass/forms/*.cpp)
  gonio_registry(${GONIO_GENERATED}/glass_forms.cpp Form glass/form.h
    "std::span<const gonio::glass::Form* const> gonio::glass::all_forms()" gonio::glass::forms ${form_files})
  file(GLOB solver_files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/lib/nrsfm/solvers/*.cpp)
  gonio_registry(${GONIO_GENERATED}/nrsfm_solvers.cpp Solver nrsfm/solve/solver.h
    "std::span<const gonio::nrsfm::Solver* const> gonio::nrsfm::all_solvers()" gonio::nrsfm::solvers ${solver_files})
  file(GLOB animatronic_files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/lib/nrsfm/animatronics/*.cpp)
  gonio_registry(${GONIO_GENERATED}/animatronics.cpp Animatronic nrsfm/make/animatronic.h
    "std::span<const gonio::nrsfm::Animatronic* const> gonio::nrsfm::all_animatronics()" gonio::nrsfm::animatronics
    ${animatronic_files})
  gonio_registry(${GONIO_GENERATED}/exchanges.cpp Exchange scene/exchange/exchange.h
    "std::span<const gonio::scene::Exchange* const> gonio::scene::all_exchanges()" gonio::scene ${exchange_files})
  file(GLOB table_model_files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/lib/explain/tables/models/*.cpp)
  gonio_registry(${GONIO_GENERATED}/table_models.cpp Model explain/tables/table_model.h
    "std::span<const gonio::explain::tables::Model* const> gonio::explain::tables::all_models()"
    gonio::explain::tables ${table_model_files})
  file(GLOB volume_files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/lib/io/volumes/*.cpp)
  gonio_registry(${GONIO_GENERATED}/volume_formats.cpp VolumeFormat io/volume.h
    "std::span<const gonio::io::VolumeFormat* const> gonio::io::all_volume_formats()" gonio::io::volumes
    ${volume_files})
  file(GLOB archive_files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/lib/print/archives/*.cpp)
  gonio_registry(${GONIO_GENERATED}/archive_formats.cpp ArchiveFormat print/archive.h
    "std::span<const gonio::print::ArchiveFormat* const> gonio::print::all_archive_formats()" gonio::print::archives
    ${archive_files})
  file(GLOB driver_files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/lib/acquisition/device/drivers/*.cpp)
  gonio_registry(${GONIO_GENERATED}/drivers.cpp Driver acquisition/device/devices.h
    "std::span<const gonio::acquisition::Driver* const> gonio::acquisition::all_drivers()"
    gonio::acquisition::drivers ${driver_files})
  file(GLOB view_pattern_files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/lib/acquisition/plan/patterns/*.cpp)
  gonio_registry(${GONIO_GENERATED}/view_patterns.cpp ViewPattern acquisition/plan/view_pattern.h
    "std::span<const gonio::acquisition::ViewPattern* const> gonio::acquisition::all_view_patterns()"
    gonio::acquisition::patterns ${view_pattern_files})
  # Where simulators bind to mechanisms (tests/meta/bindings_test knows these folders).
  gonio_bindings(scene/edits Edit scene/edit.h gonio::scene all_edits edits)
  gonio_bindings(render/links Link render/link.h gonio::render all_links links)
  gonio_bindings(relighting/terms Term relighting/term.h gonio::relighting all_terms terms)
  gonio_bindings(explain/tables/terms Term explain/tables/table_model.h gonio::explain::tables all_terms terms)
  gonio_bindings(explain/tables/reflectance ReflectanceBinding explain/tables/reflectance_binding.h
    gonio::explain::tables all_reflectance_bindings reflectance)
  gonio_bindings(explain/stacks/exposures ExposureBinding explain/stacks/exposure_binding.h gonio::explain::stacks
    all_exposure_bindings exposures)
  gonio_bindings(explain/stacks/lights LightBinding explain/stacks/light_binding.h gonio::explain::stacks
    all_light_bindings lights)
  gonio_bindings(explain/volumes/terms Term explain/volumes/volume_term.h gonio::explain::volumes all_terms terms)
  gonio_bindings(explain/prints/terms Term explain/prints/print_term.h gonio::explain::prints all_terms terms)
  gonio_bindings(explain/polarization/terms Term explain/polarization/polarization_term.h gonio::explain::polarization
    all_terms terms)
  gonio_registry(${GONIO_GENERATED}/domains.cpp Domain explain/domain.h
    "std::span<const gonio::explain::Domain* const> gonio::explain::all_domains()" gonio::explain::domains
    ${domain_files})
  set(objects "")
  foreach(room IN LISTS GONIO_ROOMS)
    list(APPEND objects $<TARGET_OBJECTS:${room}>)
  endforeach()
  set(registries ${GONIO_GENERATED}/mechanisms.cpp ${GONIO_GENERATED}/domains.cpp
      ${GONIO_GENERATED}/table_models.cpp ${GONIO_GENERATED}/microstructures.cpp ${GONIO_GENERATED}/glass_forms.cpp ${bindings}
      ${GONIO_GENERATED}/nrsfm_solvers.cpp ${GONIO_GENERATED}/animatronics.cpp
      ${GONIO_GENERATED}/volume_formats.cpp ${GONIO_GENERATED}/archive_formats.cpp
      ${GONIO_GENERATED}/drivers.cpp ${GONIO_GENERATED}/view_patterns.cpp)
  if(EXISTS ${CMAKE_SOURCE_DIR}/lib/surface/surface.h)
    list(APPEND registries ${GONIO_GENERATED}/surfaces.cpp ${GONIO_GENERATED}/laws.cpp)
  endif()
  if(EXISTS ${CMAKE_SOURCE_DIR}/lib/light/light.h)
    list(APPEND registries ${GONIO_GENERATED}/lights.cpp)
  endif()
  if(EXISTS ${CMAKE_SOURCE_DIR}/lib/scene/exchange/exchange.h)
    list(APPEND registries ${GONIO_GENERATED}/exchanges.cpp)
  endif()
  add_library(gonio STATIC ${objects} ${registries})
  target_include_directories(gonio PUBLIC ${CMAKE_SOURCE_DIR}/lib)
  list(REMOVE_DUPLICATES GONIO_THIRD_PARTY)
  target_link_libraries(gonio PUBLIC ${GONIO_THIRD_PARTY})
  add_dependencies(gonio ${GONIO_MODULES})
endfunction()

# A folder tools/<name> is a program: its program.cpp defines gonio::tools::<name_>::gonio_program(), what stands beside
# that belongs to it alone, and it becomes the executable <name> in build/bin.
# gonio-describe, an executable that is not installed, knows them all and prints man pages, schemas and completions.
function(gonio_tools)
  file(GLOB mains CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/tools/*/program.cpp)
  set(sources "")
  set(declarations "")
  set(entries "")
  set(names "")
  foreach(main IN LISTS mains)
    get_filename_component(folder ${main} DIRECTORY)
    get_filename_component(name ${folder} NAME)
    string(REPLACE "-" "_" symbol ${name})
    file(GLOB own CONFIGURE_DEPENDS ${folder}/*.cpp)
    gonio_in_units(own tools ${name})
    list(APPEND sources ${own})
    list(APPEND names ${name})
    string(APPEND declarations "namespace gonio::tools::${symbol} { const gonio::cli::Program& gonio_program(); }\n")
    string(APPEND entries "      &gonio::tools::${symbol}::gonio_program(),\n")
    file(GENERATE OUTPUT ${GONIO_GENERATED}/main_${name}.cpp CONTENT
"// Generated by cmake/rooms.cmake; do not edit.
#include \"cli/program.h\"
namespace gonio::tools::${symbol} { const gonio::cli::Program& gonio_program(); }
int main(int argc, char** argv) { return gonio::cli::main(gonio::tools::${symbol}::gonio_program(), argc, argv); }
")
    add_executable(${name} ${GONIO_GENERATED}/main_${name}.cpp)
    target_link_libraries(${name} PRIVATE gonio_programs gonio)
    set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
  endforeach()
  list(LENGTH names count)
  file(GENERATE OUTPUT ${GONIO_GENERATED}/programs.cpp CONTENT
"// Generated by cmake/rooms.cmake; do not edit.
#include <array>
#include \"cli/program.h\"
${declarations}
std::span<const gonio::cli::Program* const> gonio::cli::all_programs() {
  static const std::array<const Program*, ${count}> all = {
${entries}  };
  return all;
}
")
  add_library(gonio_programs STATIC ${GONIO_GENERATED}/programs.cpp ${sources})
  target_include_directories(gonio_programs PUBLIC ${CMAKE_SOURCE_DIR})  # "tools/<name>/call.h"
  target_compile_definitions(gonio_programs PRIVATE GONIO_VERSION="${PROJECT_VERSION}")
  target_link_libraries(gonio_programs PUBLIC gonio)
  gonio_allow_units(gonio_programs)
  add_executable(gonio-describe ${CMAKE_SOURCE_DIR}/man/gonio_describe.cpp)
  target_link_libraries(gonio-describe PRIVATE gonio_programs gonio)
  set(GONIO_TOOL_NAMES ${names} CACHE INTERNAL "")
  add_custom_target(programs DEPENDS ${names})  # what users run: no tests, nothing that only prints documents
endfunction()
