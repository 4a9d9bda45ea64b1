// Seeds of single images: pictures of one scene must not share their noise, and none depends on which others are made.
#pragma once
#include <cstdint>
#include <string_view>

#include "base/random.h"

namespace gonio::render {

// FNV-1a of the image's id, mixed with the seed that the user gave.
inline std::uint64_t seed_of(std::uint64_t seed, std::string_view image_id) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : image_id) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return split_mix(seed) ^ hash;
}

}  // namespace gonio::render
