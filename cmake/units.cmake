# Units: several sources compiled as one, so that headers and templates are read once for all of them (cmake/units.pl says
# which sources go together, and why a unit means the same). A whole build takes a fraction of the time; after an edit the
# rest of the unit is compiled again, so the preset `develop` does without.

# gonio_make_units(TREE ROOT LINES FEWEST HOW FOLDER...): writes the units of each FOLDER of TREE that has at least FEWEST
# sources, of about LINES lines each. HOW: GLOB, a folder's own sources; GLOB_RECURSE, those below it as well. Includes
# start from lib/ or from ROOT.
function(gonio_make_units tree root lines fewest how)
  find_program(PERL perl)
  if(NOT GONIO_UNITS OR NOT PERL)
    return()
  endif()
  set(request "")
  foreach(folder IN LISTS ARGN)
    string(REPLACE "/" "_" name ${folder})
    file(${how} sources ${CMAKE_SOURCE_DIR}/${tree}/${folder}/*.cpp)
    list(FILTER sources EXCLUDE REGEX "_module\\.cpp$")  # linked by themselves: gonio_module
    list(LENGTH sources count)
    if(NOT count LESS fewest)
      list(JOIN sources " " sources)
      string(APPEND request "${name} ${sources}\n")
    endif()
  endforeach()
  file(WRITE ${CMAKE_BINARY_DIR}/units/${tree}.request "${request}")
  execute_process(COMMAND ${PERL} ${CMAKE_SOURCE_DIR}/cmake/units.pl ${CMAKE_BINARY_DIR}/units/${tree}
                          ${root} ${CMAKE_SOURCE_DIR}/lib ${lines}
                  INPUT_FILE ${CMAKE_BINARY_DIR}/units/${tree}.request OUTPUT_VARIABLE answer COMMAND_ERROR_IS_FATAL ANY)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/cmake/units.pl)
  string(STRIP "${answer}" answer)
  string(REPLACE ";" "|" answer "${answer}")
  string(REPLACE "\n" ";" answer "${answer}")
  foreach(line IN LISTS answer)
    string(REPLACE "|" ";" units "${line}")
    list(POP_FRONT units name)
    set_property(GLOBAL PROPERTY GONIO_UNITS_${tree}/${name} ${units})
  endforeach()
endfunction()

# gonio_in_units(SOURCES TREE FOLDER): puts the units of TREE/FOLDER into the variable SOURCES, where there are any.
function(gonio_in_units sources tree folder)
  string(REPLACE "/" "_" name ${folder})
  get_property(units GLOBAL PROPERTY GONIO_UNITS_${tree}/${name})
  if(units)
    set(${sources} ${units} PARENT_SCOPE)
  endif()
endfunction()

# gonio_allow_units(TARGET): in a unit every source counts as a header, and what a type private to one source holds
# alarms GCC.
function(gonio_allow_units target)
  if(GONIO_UNITS)
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
endfunction()
