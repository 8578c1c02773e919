/* Feeds saved inputs to a fuzz target without a fuzzer: replay FILE|DIRECTORY ... Prints a line for
 * each file; a failure is a crash. */
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static int replay_file(const char *path)
{
    FILE *file = fopen(path, "rb");
    uint8_t *bytes = NULL;
    long count = -1;

    if (file && fseek(file, 0, SEEK_END) == 0) count = ftell(file);
    if (count >= 0) bytes = malloc((size_t)count + 1);
    if (!bytes || fseek(file, 0, SEEK_SET) != 0 ||
        fread(bytes, 1, (size_t)count, file) != (size_t)count) {
        printf("not ok - %s cannot be read\n", path);
        count = -1;
    } else {
        /* Exactly as large as the input, so that the sanitizer sees a read beyond its end. */
        uint8_t *exact = malloc(count > 0 ? (size_t)count : 1);
        memcpy(exact, bytes, (size_t)count);
        LLVMFuzzerTestOneInput(exact, (size_t)count);
        free(exact);
        printf("ok - %s\n", path);
    }
    free(bytes);
    if (file) fclose(file);
    return count >= 0;
}

static int replay_directory(DIR *directory, const char *path)
{
    int good = 1;

    for (struct dirent *entry; (entry = readdir(directory)) != NULL;) {
        char name[4096];
        if (entry->d_name[0] == '.') continue;
        snprintf(name, sizeof(name), "%s/%s", path, entry->d_name);
        good &= replay_file(name);
    }
    closedir(directory);
    return good;
}

int main(int argc, char **argv)
{
    int good = argc > 1;

    for (int i = 1; i < argc; i++) {
        DIR *directory = opendir(argv[i]);
        good &= directory ? replay_directory(directory, argv[i]) : replay_file(argv[i]);
    }
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
