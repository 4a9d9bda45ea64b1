// The binary archives of Chitubox, .ctb and .cbddlp (.photon): a head, runs of pixels, and tables that say where each
// part lies, all little endian and of single precision.
//
// After catibo, doc/cbddlp-ctb.adoc (records, runs, previews, level sets) and src/crypto.rs (the key stream, of which
// the document has a digit wrong), and UVtools, ChituboxFile.cs (greys of 7 bits, positions). Lengths are millimetres,
// speeds mm/min, resin ml and g. Written is version 2 without a key; read are versions 1 to 4, with and without. The
// layer table stands behind the layers, so that they can be written one by one: parts are found by their places alone.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "print/archive.h"

namespace gonio::print {

constexpr std::uint32_t cbddlp_magic = 0x12fd0019, ctb_magic = 0x12fd0086, ctb4_magic = 0x12fd0106,
                        locked_ctb_magic = 0x12fd0107;
constexpr std::size_t written_level_sets = 8;  // of cbddlp

std::uint32_t chitubox_magic(std::string_view beginning);  // 0: too short

std::unique_ptr<ArchiveReader> open_chitubox(const std::filesystem::path& path);
// Error(data) for a job without exposure or size of pixels, with more than two previews, or mirrored top to bottom.
std::unique_ptr<ArchiveWriter> begin_chitubox(const ArchiveFormat& format, const std::filesystem::path& path,
                                              const Job& job, std::uint32_t magic);

// Greys of 7 bits: a byte, or a byte with its highest bit set and a length of one to four bytes.
std::string encode_grey_runs(std::span<const std::uint8_t> picture);
// Bits above a falling threshold, a byte a run, as `written_level_sets` texts behind their lengths (32 bit each).
std::string encode_level_sets(std::span<const std::uint8_t> picture);

}  // namespace gonio::print
