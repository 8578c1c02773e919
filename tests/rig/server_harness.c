#include "server_harness.h"
#include "pack_fixture.h"

#include <arpa/inet.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- the server ---- */

/* The folder this program runs from: build/tests, beside build/bin. */
static void own_folder(char out[512])
{
    ssize_t length = readlink("/proc/self/exe", out, 511);
    out[length > 0 ? length : 0] = 0;
    char *slash = strrchr(out, '/');
    if (slash) *slash = 0;
}

static void program_path(char *out, size_t capacity)
{
    char folder[512];
    own_folder(folder);
    snprintf(out, capacity, "%s/../bin/farfield-server", folder);
}

static int write_pack(const char *path)
{
    size_t size;
    uint8_t *bytes = pack_fixture_usual(&size);
    FILE *file = fopen(path, "wb");
    int ok = bytes && file && fwrite(bytes, 1, size, file) == size;
    if (file) ok &= fclose(file) == 0;
    free(bytes);
    return ok;
}

static void run_server(const char *pack, const char *options, int out_fd)
{
    char program[640], copy[256],
        *argument[32] = { program, (char *)"--pack", (char *)(uintptr_t)pack, (char *)"--listen",
                          (char *)"127.0.0.1:0" };
    int count = 5;
    program_path(program, sizeof program);
    snprintf(copy, sizeof copy, "%s", options);
    for (char *word = strtok(copy, " "); word && count < 31; word = strtok(NULL, " "))
        argument[count++] = word;
    argument[count] = NULL;
    dup2(out_fd, 1);
    execv(program, argument);
    fprintf(stderr, "cannot run %s: %s\n", program, strerror(errno));
    _exit(127);
}

/* The port from "... listening on 127.0.0.1:PORT, ..."; 0: it did not come up. */
static int read_port(int fd)
{
    char line[512];
    size_t count = 0;
    while (count + 1 < sizeof line && read(fd, line + count, 1) == 1 && line[count] != '\n')
        count++;
    line[count] = 0;
    const char *address = strstr(line, "127.0.0.1:");
    return address ? atoi(address + strlen("127.0.0.1:")) : 0;
}

int harness_start(harness_server *server, const char *options)
{
    int out[2];
    char folder[512];
    memset(server, 0, sizeof *server);
    own_folder(folder);
    snprintf(server->pack_path, sizeof server->pack_path, "%s/server-%d.ffp", folder,
             (int)getpid());
    if (!write_pack(server->pack_path) || pipe2(out, O_CLOEXEC) != 0) return 0;
    server->pid = fork();
    if (server->pid == 0) run_server(server->pack_path, options, out[1]);
    close(out[1]);
    server->out_fd = out[0];
    server->port = read_port(out[0]);
    return server->port != 0;
}

int harness_stop(harness_server *server)
{
    int status, result = -1;
    kill(server->pid, SIGTERM);
    for (int i = 0; i < HARNESS_TRIES && result == -1; i++) {
        pid_t pid = waitpid(server->pid, &status, WNOHANG);
        if (pid == server->pid)
            result = WIFEXITED(status) ? WEXITSTATUS(status) : -2;
        else
            usleep(HARNESS_LOOK_US);
    }
    if (result == -1) kill(server->pid, SIGKILL);
    close(server->out_fd);
    unlink(server->pack_path);
    return result;
}

int harness_children(const harness_server *server, pid_t children[HARNESS_CHILDREN_MAX])
{
    char path[64];
    int count = 0, pid;
    snprintf(path, sizeof path, "/proc/%d/task/%d/children", (int)server->pid, (int)server->pid);
    FILE *file = fopen(path, "r");
    if (!file) return 0;
    while (count < HARNESS_CHILDREN_MAX && fscanf(file, "%d", &pid) == 1) children[count++] = pid;
    fclose(file);
    return count;
}

/* A dead process that nobody has waited for yet: an orphan's new parent may be slow. */
static int is_zombie(pid_t pid)
{
    char path[64], state = 0;
    snprintf(path, sizeof path, "/proc/%d/stat", (int)pid);
    FILE *file = fopen(path, "r");
    int found = file && fscanf(file, "%*d (%*[^)]) %c", &state) == 1;
    if (file) fclose(file);
    return found && state == 'Z';
}

int harness_gone(pid_t pid)
{
    for (int i = 0; i < HARNESS_TRIES; i++) {
        if ((kill(pid, 0) != 0 && errno == ESRCH) || is_zombie(pid)) return 1;
        usleep(HARNESS_LOOK_US);
    }
    return 0;
}

int harness_wait_children(const harness_server *server, int count, pid_t not_this)
{
    for (int i = 0; i < HARNESS_TRIES; i++) {
        pid_t child[HARNESS_CHILDREN_MAX];
        int found = harness_children(server, child), stale = 0;
        for (int c = 0; c < found; c++) stale |= child[c] == not_this;
        if (found == count && !stale) return 1;
        usleep(HARNESS_LOOK_US);
    }
    return 0;
}

/* ---- clients ---- */

harness_client *harness_connect(const harness_server *server, int greet)
{
    harness_client *client = calloc(1, sizeof *client);
    struct sockaddr_in address = { .sin_family = AF_INET,
                                   .sin_port = htons((uint16_t)server->port) };
    ff_message message = { .type = FF_MSG_HELLO, .u.hello = { FF_PROTOCOL_VERSION, 0 } },
               caps = { .type = FF_MSG_CAPS };
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (!client) return NULL;
    client->fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    int ok = connect(client->fd, (struct sockaddr *)&address, sizeof address) == 0;
    if (ok && greet)
        ok = harness_tell(client, &message) && harness_tell(client, &caps) &&
             harness_hear(client, &message) == 1 && message.type == FF_MSG_WELCOME;
    if (ok) return client;
    harness_close(client);
    return NULL;
}

void harness_close(harness_client *client)
{
    close(client->fd);
    free(client);
}

int harness_send(harness_client *client, const void *bytes, size_t count)
{
    return send(client->fd, bytes, count, MSG_NOSIGNAL) == (ssize_t)count;
}

int harness_tell(harness_client *client, const ff_message *message)
{
    uint8_t bytes[64];
    int count = ff_message_encode(message, bytes, sizeof bytes);
    return count > 0 && harness_send(client, bytes, (size_t)count);
}

int harness_hear(harness_client *client, ff_message *message)
{
    client->count -= client->used;
    memmove(client->bytes, client->bytes + client->used, client->count);
    client->used = 0;
    for (int i = 0; i < HARNESS_TRIES;) {
        int rc = ff_message_decode(client->bytes, client->count, message);
        if (rc != 0) {
            client->used = rc > 0 ? (size_t)rc : 0;
            return rc > 0 ? 1 : -1;
        }
        struct pollfd ready = { .fd = client->fd, .events = POLLIN };
        if (poll(&ready, 1, HARNESS_LOOK_US / 1000) <= 0) {
            i++;
            continue;
        }
        ssize_t got = recv(client->fd, client->bytes + client->count,
                           sizeof client->bytes - client->count, 0);
        if (got <= 0) return 0;
        client->count += (size_t)got;
    }
    return -1;
}

/* Inode of the server's end of a connection, from /proc/net/tcp; 0: not found. */
static unsigned long server_inode(const harness_server *server, const harness_client *client)
{
    struct sockaddr_in mine;
    socklen_t size = sizeof mine;
    char line[512];
    unsigned long inode = 0;
    FILE *table = fopen("/proc/net/tcp", "r");
    if (!table || getsockname(client->fd, (struct sockaddr *)&mine, &size) != 0) return 0;
    while (!inode && fgets(line, sizeof line, table)) {
        unsigned local_port, remote_port;
        unsigned long found;
        if (sscanf(line, " %*d: %*x:%x %*x:%x %*x %*s %*s %*s %*d %*d %lu", &local_port,
                   &remote_port, &found) == 3 &&
            local_port == (unsigned)server->port && remote_port == ntohs(mine.sin_port))
            inode = found;
    }
    fclose(table);
    return inode;
}

static int holds_socket(pid_t pid, unsigned long inode)
{
    char folder[64], wanted[64], path[400], target[64];
    int held = 0;
    snprintf(folder, sizeof folder, "/proc/%d/fd", (int)pid);
    snprintf(wanted, sizeof wanted, "socket:[%lu]", inode);
    DIR *files = opendir(folder);
    for (struct dirent *entry; files && !held && (entry = readdir(files));) {
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        ssize_t length = readlink(path, target, sizeof target - 1);
        target[length > 0 ? length : 0] = 0;
        held = strcmp(target, wanted) == 0;
    }
    if (files) closedir(files);
    return held;
}

pid_t harness_served_by(const harness_server *server, const harness_client *client)
{
    pid_t child[HARNESS_CHILDREN_MAX];
    unsigned long inode = server_inode(server, client);
    int count = harness_children(server, child);
    for (int i = 0; inode && i < count; i++)
        if (holds_socket(child[i], inode)) return child[i];
    return 0;
}

int harness_root_comes(harness_client *client, uint32_t tile)
{
    ff_message message = { .type = FF_MSG_GET,
                           .kind = FF_KIND_ROOT,
                           .u.get = { .key = ff_key_make(tile % 4u, 0, 0) } };
    return harness_tell(client, &message) && harness_hear(client, &message) == 1 &&
           message.type == FF_MSG_ANSWER && message.kind == FF_KIND_ROOT;
}

int harness_panorama_comes(harness_client *client, uint16_t id)
{
    ff_message message = { .type = FF_MSG_GET, .kind = FF_KIND_FACE };
    message.u.panorama = (ff_get_panorama){ .id = id,
                                            .position_wu = { 500000, 500000, 400000 },
                                            .front_wu = 50000,
                                            .back_wu = 10000000,
                                            .face_size = 128,
                                            .quality = 70,
                                            .face_count = 4,
                                            .face = { 0, 1, 2, 3 } };
    if (!harness_tell(client, &message)) return -1;
    for (int faces = 0;; faces++) {
        if (harness_hear(client, &message) != 1) return -1;
        if (message.type == FF_MSG_FAILED && message.u.failed.id == id) return 0;
        if (message.type != FF_MSG_ANSWER || message.kind != FF_KIND_FACE ||
            message.u.face.id != id || message.u.face.face != faces)
            return -1;
        if (message.u.face.flags & FF_FACE_LAST) return faces == 3 ? 1 : -1;
    }
}
