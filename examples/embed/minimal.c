/* The smallest application in C: runs a config that has sources of its own to its end and prints the figures. */
#include <pelorus/embed.h>
#include <stdio.h>

int main(int count, char** arguments) {
    plr_error error = {.struct_size = sizeof error};
    pelorus_options options = {.struct_size = sizeof options, .result_folder = count > 2 ? arguments[2] : NULL};
    pelorus_scalar_info scalar = {.struct_size = sizeof scalar};
    pelorus_pipeline* pipeline = NULL;
    plr_status status = pelorus_open(count > 1 ? arguments[1] : NULL, &options, &pipeline, &error);
    if (status == PLR_OK) status = pelorus_play(pipeline, &error);
    if (status == PLR_OK) status = pelorus_finish(pipeline, &error);
    if (status != PLR_OK) fprintf(stderr, "%s\n", pelorus_error_text());
    for (uint32_t i = 0; status == PLR_OK && pelorus_scalar(pipeline, i, &scalar, NULL) == PLR_OK; ++i)
        printf("%s %g %s\n", scalar.name, scalar.value, scalar.unit);
    pelorus_close(pipeline);
    return status == PLR_OK ? 0 : 1;
}
