// Addresses read and written.
#include "tools/monitor/address.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/un.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "rt/base/text.hpp"

namespace surefoot::monitor {

namespace {

constexpr std::string_view forms = "Write unix:/run/surefoot/surefoot.sock or 127.0.0.1:9464";

bool is_loopback(const std::string& host) {
    in_addr four{};
    if (inet_pton(AF_INET, host.c_str(), &four) == 1) return (ntohl(four.s_addr) >> 24U) == 127;
    in6_addr six{};
    return inet_pton(AF_INET6, host.c_str(), &six) == 1 && IN6_IS_ADDR_LOOPBACK(&six);
}

Result<Address> parse_socket(const std::string& text, const std::string& path) {
    if (path.empty()) return Error{text, "The address names no socket", std::string(forms), ErrorKind::misuse};
    if (path.size() >= sizeof(sockaddr_un::sun_path)) {
        return Error{text,
                     fmt::format("The path is too long for a socket: {} characters, at most {}", path.size(),
                                 sizeof(sockaddr_un::sun_path) - 1),
                     "Choose a shorter path", ErrorKind::misuse};
    }
    Address address;
    address.socket_path = path;
    return address;
}

}  // namespace

std::string Address::text() const {
    if (!socket_path.empty()) return "unix:" + socket_path;
    return host.find(':') != std::string::npos ? fmt::format("[{}]:{}", host, port) : fmt::format("{}:{}", host, port);
}

Result<Address> parse_address(const std::string& text) {
    constexpr std::string_view unix_prefix = "unix:";
    if (text.starts_with(unix_prefix)) return parse_socket(text, text.substr(unix_prefix.size()));
    if (text.find('/') != std::string::npos) return parse_socket(text, text);
    const std::size_t colon = text.rfind(':');
    if (colon == std::string::npos)
        return Error{text.empty() ? "address" : text, "This is not an address", std::string(forms), ErrorKind::misuse};
    Address address;
    address.host = text.substr(0, colon);
    if (address.host.size() > 2 && address.host.front() == '[' && address.host.back() == ']')
        address.host = address.host.substr(1, address.host.size() - 2);
    if (address.host == "localhost") address.host = "127.0.0.1";
    const auto port = number_in<std::uint16_t>(std::string_view(text).substr(colon + 1));
    if (!port) return Error{text, "The address has no port from 0 to 65535", std::string(forms), ErrorKind::misuse};
    address.port = *port;
    if (!is_loopback(address.host)) {
        return Error{text, "The address is not on loopback: everyone who reaches this machine could read the figures",
                     "Name 127.0.0.1, [::1] or a socket. For access from elsewhere, use a proxy with a login", ErrorKind::misuse};
    }
    return address;
}

bool host_is_loopback(std::string_view host) {
    const std::size_t bracket = host.starts_with('[') ? host.find(']') : std::string_view::npos;
    const std::size_t colon = host.find(':', bracket == std::string_view::npos ? 0 : bracket);
    if (colon != std::string_view::npos) {
        const std::string_view port = host.substr(colon + 1);
        if (port.size() > 5 || port.find_first_not_of("0123456789") != std::string_view::npos) return false;
        host = host.substr(0, colon);
    }
    if (bracket != std::string_view::npos) return host == "[::1]";
    constexpr std::string_view local = "localhost";
    const auto same = [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; };
    if (std::equal(host.begin(), host.end(), local.begin(), local.end(), same)) return true;
    return host.find(':') == std::string_view::npos && is_loopback(std::string(host));
}

std::string default_address() {
    const char* folder = std::getenv("RUNTIME_DIRECTORY");  // NOLINT(concurrency-mt-unsafe): never set while running
    std::string where = folder != nullptr && *folder != '\0' ? folder : "/run/surefoot";
    where = where.substr(0, where.find(':'));  // systemd may name several
    return "unix:" + where + "/surefoot.sock";
}

SocketAddress socket_address(const Address& address) {
    SocketAddress out;
    if (!address.socket_path.empty()) {
        auto& un = reinterpret_cast<sockaddr_un&>(out.storage);
        un.sun_family = AF_UNIX;
        std::memcpy(un.sun_path, address.socket_path.c_str(), address.socket_path.size() + 1);
        out.length = sizeof(sockaddr_un);
        return out;
    }
    auto& four = reinterpret_cast<sockaddr_in&>(out.storage);
    if (inet_pton(AF_INET, address.host.c_str(), &four.sin_addr) == 1) {
        four.sin_family = AF_INET;
        four.sin_port = htons(address.port);
        out.length = sizeof(sockaddr_in);
        return out;
    }
    auto& six = reinterpret_cast<sockaddr_in6&>(out.storage);
    (void)inet_pton(AF_INET6, address.host.c_str(), &six.sin6_addr);
    six.sin6_family = AF_INET6;
    six.sin6_port = htons(address.port);
    out.length = sizeof(sockaddr_in6);
    return out;
}

}  // namespace surefoot::monitor
