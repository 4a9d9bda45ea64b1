// Samples as they are stored become the floats of a VolumeSource.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "io/volume.h"
#include "io/volume_bytes.h"

namespace gonio::io {

// Values of to.size() samples: slope * stored + intercept. `swapped`: their order of bytes is not this machine's.
void decode_samples(std::span<const char> bytes, VoxelType type, bool swapped, double slope, double intercept,
                    std::span<float> to);
bool is_swapped(bool big_endian);

// Error(data) at "FILE#slice K" where one of the values of slices `first`, first + 1, ... is no number or infinite.
void check_samples(std::span<const float> values, const VolumeHead& head, std::size_t first);

// What every read() asks: do the slices exist, does `to` have their length? Error(internal): the caller's fault.
void check_slices(const VolumeHead& head, std::size_t first, std::size_t count, std::span<float> to);

// Slices one behind the other, i fastest.
std::unique_ptr<VolumeSource> linear_volume(VolumeHead head, std::unique_ptr<ByteSource> bytes, bool big_endian);

// Numbers as text, parted by blanks or commas, from byte `from` of a file on. Error(data) where the file cannot hold as
// many.
std::unique_ptr<VolumeSource> text_volume(VolumeHead head, const std::filesystem::path& file, std::uint64_t from);

}  // namespace gonio::io
