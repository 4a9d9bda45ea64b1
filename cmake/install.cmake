# `cmake --install`: programs by their bare names in bin/, and beside it lib/gonio with what they load, share/ with manual pages (which `man` finds because
# bin/ is on the PATH), completions of three shells, the manifest's schemas and the documents.
include(GNUInstallDirs)

install(TARGETS ${GONIO_TOOL_NAMES} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS ${GONIO_MODULES} LIBRARY DESTINATION ${CMAKE_INSTALL_BINDIR}/../lib/gonio)

# Every file of FOLDER that matches PATTERN goes to DESTINATION; a folder that does not exist has none.
function(gonio_install_files folder pattern destination)
  file(GLOB files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${folder}/${pattern})
  if(files)
    install(FILES ${files} DESTINATION ${destination})
  endif()
endfunction()

foreach(section 1 5 7)
  gonio_install_files(man *.${section} ${CMAKE_INSTALL_MANDIR}/man${section})
endforeach()
gonio_install_files(completions/bash * ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
gonio_install_files(completions/zsh _* ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
gonio_install_files(completions/fish *.fish ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
gonio_install_files(schemas *.json ${CMAKE_INSTALL_DATADIR}/gonio/schemas)
gonio_install_files(. README.md ${CMAKE_INSTALL_DOCDIR})
gonio_install_files(. LICENSE ${CMAKE_INSTALL_DOCDIR})
