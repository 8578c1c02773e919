"""The most stack that the core can take: the worst path over the call graph, from GCC's -fcallgraph-info=su (frames and direct calls of each
file) and, for what it calls of zlib, libgcc and the C library, from the disassembly. Calls through pointers are resolved by the list below:
one that is not listed is an error, and so is recursion."""
import re

from handheld_counts import map_sections, run

CORE = ("protocol/", "client/", "common3d/")
LIMIT = 4096  # bytes; DESIGN.md, chapter 11
# Calls through pointers: pattern of the caller, pattern of all it can reach. Names are "file.c:name" for static functions. A row that no
# caller needs any more is an error.
THROUGH_POINTERS = [
    (r"c3d_device\.c:lay_out|^c3d_bytes", r"soft/c3d_soft\.c:soft_state_bytes"),
    (r"^c3d_open$", r"soft/c3d_soft\.c:soft_(open|close|state_bytes)"),
    (r"^c3d_close$", r"soft/c3d_soft\.c:soft_(texture_drop|close)"),
    (r"^c3d_texture_make", r"^soft_texture_upload$"),
    (r"^c3d_texture_free", r"soft/c3d_soft\.c:soft_texture_drop"),
    (r"^c3d_mesh_|c3d_device\.c:((finish|give)_strip|copy_mesh)$", None),  # buffers of a GL: the soft back end has none
    (r"^c3d_strip_free$", r"soft/c3d_soft\.c:soft_end"),
    (r"^c3d_begin$", r"soft/c3d_soft\.c:soft_begin"),
    (r"^c3d_draw_strip$", r"soft/c3d_soft\.c:soft_draw$"),
    (r"^c3d_draw_points$", r"soft/c3d_soft\.c:soft_draw_points$"),
    (r"^c3d_draw_label$", r"^soft_label$"),
    (r"^c3d_overlay$", r"soft/c3d_soft\.c:soft_overlay"),
    (r"^c3d_end$", r"soft/c3d_soft\.c:soft_end"),
    (r"^c3d_read_rgb$", r"soft/c3d_soft\.c:soft_read_rows"),
    (r"^c3d_frame_pixels$", r"soft/c3d_soft\.c:soft_pixels"),
    (r"^soft_|soft/soft_[a-z]+\.c:", r"soft_spans\.c:span_|^soft_segment_paint$"),
    (r"^ff_decoder_|ff_decode\.c:(decode|reconstruct)$|^ff_(decode|reconstruct)_",
     r"^ff_[a-z]+_(memory|decode|reconstruct)$|^ff_add_residuals$"),  # ff_codec_list.h
    (r"ff_body\.c:|^ff_take_body$", r"ff_codec_deflate\.c:take_deflated$"),
    (r"^ff_predict_children$", r"^ff_(interpolate|trained_predict)$"),  # ff_codec_list.h
    (r"ff_predict\.c:|^ff_interpolate$", r"ff_decode\.c:(add_residual|take_prediction)$"),
    (r"ff_trained_expect\.c:|^ff_expect$", r"ff_codec_trained\.c:(take_height|take_word|pass_on)$"),
    (r"ff_codec_trained\.c:pass_on$", r"ff_decode\.c:take_prediction$"),
    (r"ff_paint\.c:go_block$|^ff_paint_", r"ff_intake_far\.c:lay_block$"),
    (r"ff_pack\.c:|^ff_pack_", None),  # reads parts of a file: packs are mapped
    (r"ff_pool\.c:|^ff_tree_resha(de_beside|de|pe)$", r"ff_terrain_view\.c:on_evict$"),
    (r"ff_sets_draw\.c:|^ff_sets_make_fins$", None),  # those who watch fins: checks
    (r"^ff_held_pictures_get$", r"ff_textures\.c:find_coded$"),
    (r"^ff_node_draw$|ff_node_draw\.c:", r"^ff_sets_lay$"),
    (r"^ff_box_in_view$", r"ff_view_cull\.c:(narrow_)?beyond_plane$"),
    (r"ff_stream\.c:|^ff_stream_", r"posix/tcp\.c:tcp_|sim_tape\.c:play_"),
    (r"^inflate|^updatewindow$", r"ff_inflate\.c:arena_"),
]


# Libraries that the core calls are followed by their disassembly; a failed assertion ends the program; the rest is the platform's business.
FOLLOWED = r"^(__aeabi_\w+|__u?div\w+|__\w+di3|__memcmpeq|mem\w+|str\w+|inflate\w*|zcalloc|zcfree|adler32\w*|crc32\w*|updatewindow)$"


class Unresolved(Exception):
    pass


def row_of(name):
    return next((row for row, (caller, _) in enumerate(THROUGH_POINTERS) if re.search(caller, name)), None)


def rows_unused(callers):
    """Rows of the list that none of the functions that call through pointers needs."""
    used = {row_of(name) for name in callers}
    return [caller for row, (caller, _) in enumerate(THROUGH_POINTERS) if row not in used]


class CallGraph:
    """frame: bytes of each function; calls: what it calls; place: its source file. Functions of libraries come in as they are met."""

    def __init__(self, program):
        self.frame, self.calls, self.place, self.pointers = {}, {}, {}, set()
        for path in sorted({obj for _, _, _, obj in map_sections(program + ".map") if "/obj/" in obj}):
            self.read(open(path[:-2] + ".ci").read())
        self.library = Disassembly(program)
        self.deepest = {}

    def read(self, text):
        for title, label in re.findall(r'^node: \{ title: "([^"]+)" label: "([^"]+)" \}', text, re.M):
            _, place, size = label.split("\\n")[:3]
            self.frame[title], self.place[title] = int(size.split()[0]), place.split(":")[0]
            self.calls.setdefault(title, set())
            if "dynamic" in size and "bounded" not in size:
                raise Unresolved("%s takes an amount of stack known only when it runs" % title)
        for source, target in re.findall(r'^edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"', text, re.M):
            if target == "__indirect_call":
                self.pointers.add(source)
            else:
                self.calls.setdefault(source, set()).add(target)

    def is_core(self, name):
        return self.place.get(name, "").startswith(CORE)

    def targets(self, name):
        """What `name` can call; library functions are looked up in the disassembly."""
        if name not in self.frame:
            self.frame[name], self.calls[name], through_pointer = self.library.function(name)
            if through_pointer:
                self.pointers.add(name)
        reached = set(self.calls[name])
        if name in self.pointers:
            row = row_of(name)
            pattern = THROUGH_POINTERS[row][1] if row is not None else ""
            found = {f for f in self.place if pattern and re.search(pattern, f)}
            if not found and pattern is not None:
                raise Unresolved("%s calls through a pointer: say in THROUGH_POINTERS what it can reach" % name)
            reached |= found
        return reached

    def worst(self, name, within, above=()):
        """Bytes and path of the deepest calls that start at `name`; what lies outside `within` is not entered."""
        if name in above:
            raise Unresolved("recursion: " + " > ".join(above[above.index(name):] + (name,)))
        key = name, within
        if key not in self.deepest:
            below = [self.worst(t, within, above + (name,)) for t in sorted(self.targets(name)) if within(self, t)]
            size, path = max(below, default=(0, ()))
            self.deepest[key] = size + self.frame[name], (name,) + path
        return self.deepest[key]


class Disassembly:
    """Frames and calls of functions that came without source."""

    def __init__(self, program):
        self.lines = {}
        for line in run(["arm-linux-gnueabi-objdump", "-d", "--no-show-raw-insn", program]).splitlines():
            head = re.match(r"[0-9a-f]+ <(.+)>:$", line)
            if head:
                code = self.lines.setdefault(head.group(1), [])
            elif line.startswith(" "):
                code.append(line.split("\t")[1:])

    def function(self, name):
        size, calls, through_pointer = 0, set(), False
        for word in self.lines.get(name, []):
            op, rest = word[0], word[1] if len(word) > 1 else ""
            if op == "push" or (op.startswith("stmdb") and rest.startswith("sp!")):
                size += 4 * registers(rest)
            elif re.match(r"sub\w*$", op) and re.match(r"sp, sp, #\d+", rest):
                size += int(rest.split("#")[1].split()[0])
            elif op.startswith("str") and re.search(r"\[sp, #-(\d+)\]!", rest):
                size += int(re.search(r"#-(\d+)\]!", rest).group(1))
            elif op == "blx" and "<" not in rest:
                through_pointer = True
            elif re.match(r"b[a-z]*$", op) and "<" in rest:
                target = rest.split("<")[1].rstrip(">").split("+")[0]
                if target != name:
                    calls.add(target)
        return size, calls, through_pointer


def registers(text):
    count = 0
    for part in re.search(r"\{(.*)\}", text).group(1).split(","):
        ends = [{"fp": 11, "ip": 12, "sp": 13, "lr": 14, "pc": 15, "sl": 10}.get(r.strip(), None) or int(r.strip()[1:]) for r in part.split("-")]
        count += ends[-1] - ends[0] + 1
    return count


def core_only(graph, name):
    return graph.is_core(name) or (name not in graph.place and re.match(FOLLOWED, name) is not None)


def with_platform(graph, name):
    return name in graph.place or core_only(graph, name)


def plain(path):
    return " > ".join(p.split(":")[-1] for p in path)


def worst_paths(program, header):
    """(bytes, bytes with the platform, path of the core) of each function of the header, the deepest first."""
    graph = CallGraph(program)
    rows = []
    for root in re.findall(r"^[a-z].*?\b(ff_client_\w+)\(", open(header).read(), re.M):
        size, path = graph.worst(root, core_only)
        rows.append((size, graph.worst(root, with_platform)[0], path))
    for caller in rows_unused(graph.pointers):
        raise Unresolved("nothing calls through a pointer in %s any more: take the row out of THROUGH_POINTERS" % caller)
    return sorted(rows, reverse=True)
