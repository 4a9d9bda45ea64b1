// Sequences and reconstructions as files: MATLAB v5 (.mat), NumPy (.npz, or .npy with shapes), PLY per frame.
//
// Written .mat, the benchmark's naming: W (2F x P, NaN where missing), V (F x P, 1 where visible), S (3F x P truth),
// W_sigma (F x P, of the tracks where it is known), R (2F x 3 rows of camera_from_object), T (3F, translation), K
// (3 x 3), projection, unit_m, factors (struct of text).
// A reconstruction: S (3F x P), R, frame ("object" | "camera"), algorithm, factors.
// Read besides: names of the field's files, Shat, S_hat, X (3 x P x F), GT, Q, Rs, visibility, D (1 where MISSING),
// scale of Akhter's files (truth = S * scale, tracks = W * scale beside Shat), structs p(i).p / Pgth(i).P / v of
// perspective sets, and depths of such sets (struct initialisations: K, initialDepth: shapes are K^-1 p depth).
// X (3 x P x F) stands in each frame's camera: its x and y are orthographic tracks.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "io/mat.h"
#include "nrsfm/sequence.h"

namespace gonio::nrsfm {

struct FileNames {  // empty: found by the names above
  std::string tracks, visible, truth, shapes;
  std::filesystem::path beside;  // file with the tracks that depths belong to; empty: data_NAME.mat in their folder
};
// Error(no_input), Error(data) with file, variable, size and what was expected. `notes` gets what was assumed.
Sequence read_sequence(const std::filesystem::path& file, const FileNames& names = {},
                       std::vector<std::string>* notes = nullptr);
// `file`: .mat, .npz, .npy, or a folder or pattern (frame_*.ply) of PLY files, one per frame in the order of names,
// numbers within them compared as numbers.
Reconstruction read_reconstruction(const std::filesystem::path& file, const FileNames& names = {},
                                   std::vector<std::string>* notes = nullptr);

// Whole or not at all. `made_with`: what the program that made it was told, for `made_with_of`.
void write_sequence(const Sequence& sequence, const std::filesystem::path& file, const std::string& made_with = {});
std::string made_with_of(const std::filesystem::path& file);  // empty: not said
// `besides`: further variables, which readers of reconstructions pass over.
void write_reconstruction(const Reconstruction& reconstruction, const std::filesystem::path& file,
                          const io::MatFile& besides = {});

}  // namespace gonio::nrsfm
