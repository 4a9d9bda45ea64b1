// What a manifest has of mosaic photographs. Private to polarization/.
#pragma once
#include <string>
#include <vector>

#include "explain/polarization/polarization_state.h"
#include "manifest/sections/forward.h"
#include "mechanism/mechanism.h"

namespace gonio::explain::polarization {

// Cameras behind polarizers that have recordings, sorted.
std::vector<std::string> mosaic_cameras(const manifest::Document& document);
// The document with the recordings of one camera; the others weigh nothing.
manifest::Document images_of(manifest::Document document, const std::string& camera);
// The gain of images[entry], a factor more than it was.
void write_gain(manifest::Document& document, std::size_t entry, double factor);
// What the manifest's mechanisms have before the samples of `camera`.
photograph::PolarizerArray array_in_use(const manifest::Document& document, const std::string& camera);
double veil_in_use(const manifest::Document& document, const std::string& camera);
// On each mirror in question.
std::vector<Film> films_in_use(const manifest::Document& document, const Setup& setup);
bool is_in_use(const manifest::Document& document, const mechanism::Mechanism& mechanism, const std::string& camera);
[[noreturn]] void refuse_few(const manifest::Document& document, const std::string& camera, std::size_t rows);

}  // namespace gonio::explain::polarization
