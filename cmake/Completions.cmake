# Shell completion, printed by the program itself, in the folders where shells search: those below the prefix of the installation.
# A program that does not run on the installing machine is installed without completion.
function(evolvent_install_completions)
  set(share "${CMAKE_INSTALL_DATAROOTDIR}")
  if(SKBUILD)
    set(share "${SKBUILD_DATA_DIR}/share")
  endif()
  foreach(
    row
    bash:evolvent:bash-completion/completions
    zsh:_evolvent:zsh/site-functions
    fish:evolvent.fish:fish/vendor_completions.d
  )
    string(REPLACE ":" ";" row "${row}")
    list(GET row 0 shell)
    list(GET row 1 name)
    list(GET row 2 folder)
    set(file "${PROJECT_BINARY_DIR}/completions/${shell}/${name}")
    file(MAKE_DIRECTORY "${PROJECT_BINARY_DIR}/completions/${shell}")
    install(
      CODE
        "execute_process(COMMAND \"$<TARGET_FILE:evolvent>\" completion ${shell} OUTPUT_FILE \"${file}\" RESULT_VARIABLE failed)
        if(failed)
          message(STATUS \"Not installed: completion for ${shell} (the program does not run here)\")
          file(REMOVE \"${file}\")
        endif()"
      COMPONENT program
    )
    install(FILES "${file}" DESTINATION "${share}/${folder}" COMPONENT program OPTIONAL)
  endforeach()
endfunction()
