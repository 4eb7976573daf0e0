#include "simulation/ranks.hpp"

#include <cstdint>
#include <cstring>

namespace rabiline {

std::vector<std::string> Ranks::broadcast(const std::vector<std::string>& of_leader) {
  std::string packed;
  for (const std::string& text : of_leader) {
    const std::uint64_t length = text.size();
    packed.append(reinterpret_cast<const char*>(&length), sizeof length);
    packed += text;
  }
  packed = broadcast_bytes(std::move(packed));
  std::vector<std::string> out;
  for (std::size_t at = 0; at < packed.size();) {
    std::uint64_t length = 0;
    std::memcpy(&length, packed.data() + at, sizeof length);
    at += sizeof length;
    out.push_back(packed.substr(at, length));
    at += length;
  }
  return out;
}

void Alone::exchange_bytes(const void* own, std::size_t size, void* all) { std::memcpy(all, own, size); }

}  // namespace rabiline
