/* Grids in unnamed temporary files, read and written by rows: what keeps the memory of a bake
 * bounded.
 *
 * The file has no name from the moment it exists, so nothing is left behind however the program
 * ends. Reads and writes may come from several threads at once.
 */
#ifndef BAKE_GRID_H
#define BAKE_GRID_H

#include <stddef.h>
#include <stdint.h>

typedef struct bake_grid {
    int fd; /* -1: closed */
    uint32_t width, height;
    uint32_t cell_bytes;
} bake_grid;

#define BAKE_GRID_CLOSED ((bake_grid){ .fd = -1 })

/* Directory for temporary files, FARFIELD_TMP or TMPDIR or else the one of `near_path`; call once
 * before the first open. */
void bake_temp_setup(const char *near_path);
/* An unnamed temporary file: fd, or -1 after saying why. */
int bake_temp_open(void);

/* 0 or -1 (said). */
int bake_grid_open(bake_grid *grid, uint32_t width, uint32_t height, uint32_t cell_bytes);
void bake_grid_close(bake_grid *grid);
/* Reads or writes `count` cells of row `row` from column `column` on. 0 or -1 (said). */
int bake_grid_read(const bake_grid *grid, uint32_t row, uint32_t column, uint32_t count,
                   void *cells);
int bake_grid_write(const bake_grid *grid, uint32_t row, uint32_t column, uint32_t count,
                    const void *cells);

/* The least and the greatest of a float grid's cells. 0 or -1 (said). */
int bake_grid_range(const bake_grid *grid, float *low, float *high);

/* Whole transfers at a file position, interrupted calls continued. 0 or -1 (said). */
int bake_pread(int fd, void *bytes, size_t count, uint64_t at);
int bake_pwrite(int fd, const void *bytes, size_t count, uint64_t at);

#endif
