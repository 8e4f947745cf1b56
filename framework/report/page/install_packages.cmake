# `npm ci` in FOLDER, silent unless it fails: then in one line.
execute_process(COMMAND "${NPM}" ci --ignore-scripts --no-audit --no-fund --loglevel=error
                WORKING_DIRECTORY "${FOLDER}" RESULT_VARIABLE failed OUTPUT_QUIET ERROR_VARIABLE reason)
if(failed)
    string(REGEX MATCH "npm error [^\n]*network[^\n]*|npm error [^\n]*\n[^\n]*" told "${reason}")
    string(REPLACE "\n" "; " told "${told}")
    message(FATAL_ERROR "`npm ci` could not bring Plotly, which `pelorus report` needs: ${told}")
endif()
