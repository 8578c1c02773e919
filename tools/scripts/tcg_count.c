/* Instruction counter: a plugin of qemu's translator (TCG) for farfield-handheld. Counts exactly,
 * the same in every run.
 *
 *   qemu-arm -cpu arm1136 -plugin
 *       build/handheld/libtcg_count.so,out=counts.txt[,pages=1][,watch=HEX:BYTES]...[,helper=HEX:BYTES]...
 *       farfield-handheld ...
 *
 * The program calls functions named handheld_mark_*: they cut its run into phases. At
 * handheld_mark_start counting begins anew (what was counted before is settling); at
 * handheld_mark_frame a frame ends. Every translated block counts its executions to the phase in
 * force, under the block's address: linker map and symbols tell later which file and function that
 * was. With pages=1 every 4 KiB page of the program's memory that is executed, read or written is
 * noted: what a system with demand paging would keep resident. Each watch=FIRST-HEX:BYTES is an
 * area of memory for which bytes read and written while drawing are counted, by instruction. Each
 * helper=FIRST-HEX:BYTES is code that works for its callers (division, memset): it is counted as
 * usual, and once more to the block outside all helpers that was executed before it.
 *
 * Output, one record a line:
 *   phase NAME...
 *   frame INSTRUCTIONS-BY-PHASE...
 *   at HEX-ADDRESS LENGTH EXECUTIONS-BY-PHASE...    a block of LENGTH instructions
 *   helped HEX-ADDRESS INSTRUCTIONS-BY-PHASE...
 *   page FIRST-HEX LAST-HEX
 *   watch NUMBER HEX-ADDRESS BYTES-READ BYTES-WRITTEN
 *
 * Packages of qemu 7.2 carry no header for plugins; its API, version 1, is declared here, as far as
 * it is used. Guests of one thread. */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- qemu's side ---- */
typedef uint64_t qemu_plugin_id_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
typedef uint32_t qemu_plugin_meminfo_t;
typedef struct qemu_info_t {
    const char *target_name;
    struct {
        int min, cur;
    } version;
    bool system_emulation;
    union {
        struct {
            int smp_vcpus, max_vcpus;
        } system;
    } u;
} qemu_info_t;
enum qemu_plugin_cb_flags { QEMU_PLUGIN_CB_NO_REGS };
enum qemu_plugin_mem_rw { QEMU_PLUGIN_MEM_RW = 3 };

#define EXPORT __attribute__((visibility("default")))
EXPORT extern int qemu_plugin_version;
EXPORT int qemu_plugin_install(qemu_plugin_id_t id, const qemu_info_t *info, int argc, char **argv);
void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t id,
                                           void (*cb)(qemu_plugin_id_t id,
                                                      struct qemu_plugin_tb *tb));
void qemu_plugin_register_vcpu_tb_exec_cb(struct qemu_plugin_tb *tb,
                                          void (*cb)(unsigned vcpu, void *context),
                                          enum qemu_plugin_cb_flags flags, void *context);
void qemu_plugin_register_vcpu_mem_cb(struct qemu_plugin_insn *insn,
                                      void (*cb)(unsigned vcpu, qemu_plugin_meminfo_t info,
                                                 uint64_t at, void *context),
                                      enum qemu_plugin_cb_flags flags, enum qemu_plugin_mem_rw rw,
                                      void *context);
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t id,
                                    void (*cb)(qemu_plugin_id_t id, void *context), void *context);
bool qemu_plugin_mem_is_store(qemu_plugin_meminfo_t info);
unsigned int qemu_plugin_mem_size_shift(qemu_plugin_meminfo_t info);
uint64_t qemu_plugin_insn_vaddr(const struct qemu_plugin_insn *insn);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *tb);
uint64_t qemu_plugin_tb_vaddr(const struct qemu_plugin_tb *tb);
struct qemu_plugin_insn *qemu_plugin_tb_get_insn(const struct qemu_plugin_tb *tb, size_t index);
const char *qemu_plugin_insn_symbol(const struct qemu_plugin_insn *insn);
int qemu_plugin_version = 1;

/* ---- phases ---- */
enum phase { OUTSIDE, WORK, UPDATE, DRAW, PHASES, FRAME = PHASES, START, NO_MARK };
static const char *const mark_name[] = { "handheld_mark_outside", "handheld_mark_work",
                                         "handheld_mark_update",  "handheld_mark_draw",
                                         "handheld_mark_frame",   "handheld_mark_start" };

typedef struct block {
    struct block *next; /* of its bucket */
    uint64_t address;
    uint32_t instructions;
    enum phase mark;
    bool is_helper;
    uint64_t count[PHASES];  /* of executions */
    uint64_t helped[PHASES]; /* instructions of helpers on its behalf */
} block;

#define WATCHES 2
#define HELPERS 128

typedef struct area {
    uint64_t at, bytes;
} area;

/* An instruction that touches memory, when areas are watched. */
typedef struct access {
    struct access *next; /* of its bucket */
    uint64_t address;
    uint64_t bytes[WATCHES][2]; /* read, written */
} access;

#define BUCKETS    65536u
#define PAGES      (1u << 20) /* of a 32-bit address space */
#define PAGE_SHIFT 12

static block *bucket[BUCKETS];
static access *access_bucket[BUCKETS];
static area watch[WATCHES], helper[HELPERS];
static unsigned watches, helpers;
static block *caller; /* the last block that was no helper */
static enum phase phase_now;
static uint64_t frame_count[PHASES];
static uint8_t *page_touched; /* NULL: not asked for */
static FILE *out;

/* Finds a block, or makes it. A block that is translated anew goes on counting where it was; blocks
 * of another length at the same address count apart. */
static block *find_block(uint64_t address, uint32_t instructions)
{
    block **slot = &bucket[(address >> 2) % BUCKETS];
    for (block *b = *slot; b; b = b->next)
        if (b->address == address && b->instructions == instructions) return b;
    block *made = calloc(1, sizeof *made);
    if (!made) abort();
    *made =
        (block){ .next = *slot, .address = address, .instructions = instructions, .mark = NO_MARK };
    return *slot = made;
}

static access *find_access(uint64_t address)
{
    access **slot = &access_bucket[(address >> 2) % BUCKETS];
    for (access *a = *slot; a; a = a->next)
        if (a->address == address) return a;
    access *made = calloc(1, sizeof *made);
    if (!made) abort();
    *made = (access){ .next = *slot, .address = address };
    return *slot = made;
}

static void start(void)
{
    memset(frame_count, 0, sizeof frame_count);
    for (unsigned i = 0; i < BUCKETS; i++) {
        for (block *b = bucket[i]; b; b = b->next)
            memset(b->count, 0, sizeof b->count), memset(b->helped, 0, sizeof b->helped);
        for (access *a = access_bucket[i]; a; a = a->next) memset(a->bytes, 0, sizeof a->bytes);
    }
    rewind(out);
    fputs("phase outside work update draw\n", out);
}

static void print_counts(const uint64_t count[PHASES])
{
    for (unsigned p = 0; p < PHASES; p++) fprintf(out, " %llu", (unsigned long long)count[p]);
    fputc('\n', out);
}

static void on_block(unsigned vcpu, void *context)
{
    block *b = context;
    (void)vcpu;
    if (b->mark < PHASES) {
        phase_now = b->mark;
    } else if (b->mark == START) {
        start();
    } else if (b->mark == FRAME) {
        fputs("frame", out);
        print_counts(frame_count);
        memset(frame_count, 0, sizeof frame_count);
    }
    b->count[phase_now]++;
    if (!b->is_helper)
        caller = b;
    else if (caller)
        caller->helped[phase_now] += b->instructions;
    frame_count[phase_now] += b->instructions;
}

static void on_access(unsigned vcpu, qemu_plugin_meminfo_t info, uint64_t at, void *context)
{
    access *a = context;
    (void)vcpu;
    if (page_touched) page_touched[(at >> PAGE_SHIFT) % PAGES] = 1;
    for (unsigned i = 0; i < watches && phase_now == DRAW; i++)
        if (at - watch[i].at < watch[i].bytes)
            a->bytes[i][qemu_plugin_mem_is_store(info)] += UINT64_C(1)
                                                           << qemu_plugin_mem_size_shift(info);
}

static enum phase mark_of(const struct qemu_plugin_tb *tb)
{
    const char *symbol = qemu_plugin_insn_symbol(qemu_plugin_tb_get_insn(tb, 0));
    for (unsigned i = 0; symbol && i < sizeof mark_name / sizeof mark_name[0]; i++)
        if (!strcmp(symbol, mark_name[i])) return (enum phase)i;
    return NO_MARK;
}

static void on_translation(qemu_plugin_id_t id, struct qemu_plugin_tb *tb)
{
    size_t count = qemu_plugin_tb_n_insns(tb);
    uint64_t at = qemu_plugin_tb_vaddr(tb);
    block *b = find_block(at, (uint32_t)count);
    (void)id;
    b->mark = mark_of(tb);
    for (unsigned i = 0; i < helpers; i++) b->is_helper |= at - helper[i].at < helper[i].bytes;
    qemu_plugin_register_vcpu_tb_exec_cb(tb, on_block, QEMU_PLUGIN_CB_NO_REGS, b);
    if (page_touched)
        page_touched[(at >> PAGE_SHIFT) % PAGES] =
            page_touched[((at + 4 * count - 1) >> PAGE_SHIFT) % PAGES] = 1;
    for (size_t i = 0; i < count && (page_touched || watches); i++) {
        struct qemu_plugin_insn *insn = qemu_plugin_tb_get_insn(tb, i);
        qemu_plugin_register_vcpu_mem_cb(insn, on_access, QEMU_PLUGIN_CB_NO_REGS,
                                         QEMU_PLUGIN_MEM_RW,
                                         find_access(qemu_plugin_insn_vaddr(insn)));
    }
}

static int by_address(const void *a, const void *b)
{
    const block *x = *(const block *const *)a, *y = *(const block *const *)b;
    return x->address != y->address
               ? (x->address > y->address) - (x->address < y->address)
               : (x->instructions > y->instructions) - (x->instructions < y->instructions);
}

static void print_blocks(void)
{
    size_t count = 0, capacity = 0;
    block **list = NULL;
    for (unsigned i = 0; i < BUCKETS; i++)
        for (block *b = bucket[i]; b; b = b->next) {
            if (count == capacity &&
                !(list = realloc(list, (capacity = capacity ? 2 * capacity : 4096) * sizeof *list)))
                abort();
            list[count++] = b;
        }
    if (count) qsort(list, count, sizeof *list, by_address);
    for (size_t i = 0; i < count; i++) {
        fprintf(out, "at %llx %u", (unsigned long long)list[i]->address,
                (unsigned)list[i]->instructions);
        print_counts(list[i]->count);
        fprintf(out, "helped %llx", (unsigned long long)list[i]->address);
        print_counts(list[i]->helped);
    }
    free(list);
}

static void print_accesses(void)
{
    for (unsigned w = 0; w < watches; w++)
        for (unsigned i = 0; i < BUCKETS; i++)
            for (const access *a = access_bucket[i]; a; a = a->next)
                if (a->bytes[w][0] || a->bytes[w][1])
                    fprintf(out, "watch %u %llx %llu %llu\n", w, (unsigned long long)a->address,
                            (unsigned long long)a->bytes[w][0], (unsigned long long)a->bytes[w][1]);
}

static void print_pages(void)
{
    for (uint32_t first = 0, last; page_touched && first < PAGES; first = last + 1) {
        last = first;
        while (page_touched[first] && last + 1 < PAGES && page_touched[last + 1]) last++;
        if (page_touched[first])
            fprintf(out, "page %x000 %x000\n", (unsigned)first, (unsigned)last);
    }
}

static void write_counts(qemu_plugin_id_t id, void *context)
{
    (void)id, (void)context;
    print_blocks();
    print_accesses();
    print_pages();
    if (fclose(out)) fputs("tcg_count: the counts could not be written\n", stderr);
}

static bool parse_area(const char *text, area *parsed)
{
    char *end;
    parsed->at = strtoull(text, &end, 16);
    parsed->bytes = *end == ':' ? strtoull(end + 1, &end, 10) : 0;
    return parsed->bytes > 0 && !*end;
}

int qemu_plugin_install(qemu_plugin_id_t id, const qemu_info_t *info, int argc, char **argv)
{
    const char *path = NULL;
    (void)info;
    for (int i = 0; i < argc; i++) {
        if (!strncmp(argv[i], "out=", 4))
            path = argv[i] + 4;
        else if (!strcmp(argv[i], "pages=1") || !strcmp(argv[i], "pages=on"))
            page_touched = calloc(PAGES, 1);
        else if (!strncmp(argv[i], "watch=", 6) && watches < WATCHES)
            watches += parse_area(argv[i] + 6, &watch[watches]);
        else if (!strncmp(argv[i], "helper=", 7) && helpers < HELPERS)
            helpers += parse_area(argv[i] + 7, &helper[helpers]);
    }
    out = path ? fopen(path, "w") : NULL;
    if (!out) {
        fputs("tcg_count: out=FILE is missing, or the file cannot be written\n", stderr);
        return -1;
    }
    start();
    qemu_plugin_register_vcpu_tb_trans_cb(id, on_translation);
    qemu_plugin_register_atexit_cb(id, write_counts, NULL);
    return 0;
}
