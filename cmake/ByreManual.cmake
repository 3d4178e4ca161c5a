# What the program makes of its own commands, once it is built: manual pages, and scripts by which shells complete them.
function(byre_add_manual)
  find_package(Python3 COMPONENTS Interpreter REQUIRED)
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/share)
  set(pages_script ${CMAKE_CURRENT_SOURCE_DIR}/cmake/make_manual.py)
  file(MAKE_DIRECTORY ${folder})
  add_custom_command(
    OUTPUT ${folder}/man1/byre.1.gz ${folder}/byre.bash ${folder}/byre.zsh
    COMMAND Python3::Interpreter ${pages_script} $<TARGET_FILE:byre_cli> ${folder}/man1
    COMMAND byre_cli completion bash > ${folder}/byre.bash
    COMMAND byre_cli completion zsh > ${folder}/byre.zsh
    DEPENDS byre_cli ${pages_script}
    COMMENT "Making manual pages and completions of byre")
  add_custom_target(byre_manual ALL DEPENDS ${folder}/man1/byre.1.gz)

  install(DIRECTORY ${folder}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT program)
  install(FILES ${folder}/byre.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME byre
          COMPONENT program)
  byre_install_dir(zsh_dir share/zsh/site-functions share/zsh/vendor-completions program)
  install(FILES ${folder}/byre.zsh DESTINATION ${zsh_dir} RENAME _byre COMPONENT program)
endfunction()
