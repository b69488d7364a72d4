#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace hqslam::live {

/// Fetches http://ADDRESS:PORT/PATH: a single GET of HTTP/1.0, no redirection, no encryption;
/// answers in chunks and connections that are held open are understood all the same. The server is
/// not trusted: at most 1 MiB and 3 s in all. `address` as in Endpoint. Returns the body of an
/// answer with status 200. Throws Error.
std::string http_get(const std::array<std::uint8_t, 16>& address, std::uint16_t port,
                     const std::string& path);

}  // namespace hqslam::live
