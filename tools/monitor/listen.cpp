// Binding, and taking the place of a dead socket.
#include "tools/monitor/listen.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace surefoot::monitor {

namespace {

constexpr int max_waiting = 16;  // in the system's queue: a flood waits or is turned away there, at no cost to us

Error listen_error(const Address& address, int error) {
    std::string remedy = "Name another address";
    if (error == EACCES || error == EPERM || error == EROFS) remedy = "Name a folder that this user may write in";
    if (error == ENOENT || error == ENOTDIR) remedy = "Make its folder first, or name another address";
    if (error == EADDRINUSE) remedy = "Stop the program that listens there, or name another address";
    if (error == EADDRNOTAVAIL) remedy = "Name an address of this machine's loopback, such as 127.0.0.1";
    return {address.text(), fmt::format("The monitor cannot listen there: {}", std::strerror(error)), remedy,
            ErrorKind::unwritable};  // NOLINT(concurrency-mt-unsafe)
}

/// Success: nothing stands in the way any more.
Result<void> clear_socket(const Address& address) {
    struct stat info {};
    if (::lstat(address.socket_path.c_str(), &info) != 0) return {};
    if (!S_ISSOCK(info.st_mode))
        return Error{address.text(), "A file that is not a socket is there already", "Remove it, or name another address",
                     ErrorKind::unwritable};
    const SocketAddress to = socket_address(address);
    const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (fd < 0) return listen_error(address, errno);
    const int got = ::connect(fd, to.get(), to.length);
    const int error = got == 0 ? 0 : errno;
    ::close(fd);
    if (error == ECONNREFUSED) {  // whoever made it is dead
        ::unlink(address.socket_path.c_str());
        return {};
    }
    return listen_error(address, error == EACCES ? EACCES : EADDRINUSE);
}

}  // namespace

std::uint64_t inode_of(const std::string& path) {
    struct stat info {};
    return ::lstat(path.c_str(), &info) == 0 ? info.st_ino : 0;
}

Result<Listener> open_listener(const Address& wanted) {
    Listener l;
    l.address = wanted;
    const bool local = !wanted.socket_path.empty();
    if (local) {
        if (auto clear = clear_socket(wanted); !clear) return clear.error();
    }
    const SocketAddress at = socket_address(wanted);
    l.fd = ::socket(at.family(), SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (l.fd < 0) return listen_error(wanted, errno);
    const int on = 1;
    if (!local) (void)::setsockopt(l.fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (::bind(l.fd, at.get(), at.length) != 0 || ::listen(l.fd, max_waiting) != 0) {
        const int error = errno;
        ::close(l.fd);
        return listen_error(wanted, error);
    }
    if (local) {
        // Figures are no secret to this machine's users, as on a port; who may pass is the folder's business.
        (void)::chmod(wanted.socket_path.c_str(), 0666);
        l.socket_inode = inode_of(wanted.socket_path);
        return l;
    }
    sockaddr_storage got{};
    socklen_t length = sizeof got;
    if (::getsockname(l.fd, reinterpret_cast<sockaddr*>(&got), &length) == 0) {
        // The port stands in the same place in both families.
        l.address.port = ntohs(reinterpret_cast<const sockaddr_in&>(got).sin_port);
    }
    return l;
}

}  // namespace surefoot::monitor
