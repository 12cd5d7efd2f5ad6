# Writes the texts that PROGRAM prints about itself into FOLDER: the man pages of it and of its COMMANDS (separated by commas), compressed as
# Debian wants them, and completions for three shells.
# SPDX-License-Identifier: BSD-3-Clause
string(REPLACE "," ";" commands "${COMMANDS}")
# Pages of commands that no longer exist must go.
file(REMOVE_RECURSE ${FOLDER})
set(completions bash-completion/completions/alcove zsh/vendor-completions/_alcove fish/vendor_completions.d/alcove.fish)
foreach(file man/man1/alcove.1.gz ${completions})
  get_filename_component(parent ${FOLDER}/${file} DIRECTORY)
  file(MAKE_DIRECTORY ${parent})
endforeach()

execute_process(COMMAND ${PROGRAM} --generate man COMMAND gzip -9n OUTPUT_FILE ${FOLDER}/man/man1/alcove.1.gz COMMAND_ERROR_IS_FATAL ANY)
foreach(command ${commands})
  execute_process(COMMAND ${PROGRAM} --generate man ${command} COMMAND gzip -9n
    OUTPUT_FILE ${FOLDER}/man/man1/alcove-${command}.1.gz COMMAND_ERROR_IS_FATAL ANY)
endforeach()
set(shells bash zsh fish)
foreach(shell file IN ZIP_LISTS shells completions)
  execute_process(COMMAND ${PROGRAM} --generate ${shell} OUTPUT_FILE ${FOLDER}/${file} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
