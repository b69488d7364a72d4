#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace hqslam::live {

/// Fetches http://ADDRESS:PORT/PATH by cpp-httplib: a single GET without redirection or encryption.
/// The server is not trusted: at most 1 MiB and 3 s in all. `address` as in Endpoint. Returns the
/// body of an answer with status 200. Throws Error.
std::string http_get(const std::array<std::uint8_t, 16>& address, std::uint16_t port,
                     const std::string& path);

}  // namespace hqslam::live
