// Field tables of the sections about volumes and the markers that are found in them.
#include "manifest/field_makers.h"
#include "manifest/section_tables.h"
#include "manifest/sections/volume.h"

namespace gonio::manifest {

const std::vector<Field<IndexMap>>& index_map_fields() {
  static const std::vector<Field<IndexMap>> table{
      field("matrix", &IndexMap::matrix, "m",
            "4 x 4, its rows: takes an index [i, j, k, 1] to metres in the object's frame; its last row is 0 0 0 1")
          .needed()};
  return table;
}

const std::vector<Field<VolumeStep>>& volume_step_fields() {
  static const std::vector<Field<VolumeStep>> table{
      field("name", &VolumeStep::name, "", "of the step").needed(),
      field("how", &VolumeStep::how, "", "what was done, in words"),
      field("figures", &VolumeStep::figures, "", "what was measured, by name; the unit ends the name"),
      field("picture", &VolumeStep::picture, "", "file id")};
  return table;
}

const std::vector<Field<Volume>>& volume_fields() {
  static const std::vector<Field<Volume>> table{
      field("file", &Volume::file, "", "file id of the head, or of the first slice").needed(),
      field("slices", &Volume::slices, "", "file ids of the other files, in the order of k"),
      field("size", &Volume::size, "", "voxels [i, j, k], i along a row, k along the slices").range(1, 1 << 20),
      field("spacing_m", &Volume::spacing_m, "m", "between voxel centres [i, j, k]").positive(),
      field("volume_from_index", &Volume::volume_from_index, "", "where voxels lie; left out: spacing alone, origin 0"),
      field("type", &Volume::type, "", "of the samples as stored")
          .one_of({"uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64"}),
      field("tiles", &Volume::tiles, "", "of an atlas: [columns, rows] of slices in one picture").range(1, 1 << 16),
      field("value", &Volume::value, "", "what its values mean"),
      field("threshold", &Volume::threshold, "", "a voxel above it is inside"),
      field("connectivity", &Volume::connectivity, "", "neighbours of the inside: 6 or 26").one_of({"6", "26"}),
      sigma_field(&Volume::sigma),
      field("mesh", &Volume::mesh, "", "the surface that was made of it: name in meshes"),
      field("reference", &Volume::reference, "",
            "its shape from elsewhere, which explain holds the volume against: name in meshes"),
      field("markers_mesh", &Volume::markers_mesh, "", "the markers' surface: name in meshes"),
      field("steps", &Volume::steps, "", "what was done, in order, with its figures"),
      field("sound", &Volume::sound, "", "true: the mesh is closed, 2-manifold, oriented, without self-intersection")};
  return table;
}

const std::vector<Field<Marker>>& marker_fields() {
  static const std::vector<Field<Marker>> table{
      field("id", &Marker::id, "", "unique").needed(),
      field("object", &Marker::object, "", "whose frame the centre is given in; left out: the volume's"),
      field("volume", &Marker::volume, "", "where it was found: name in volumes"),
      field("centre_m", &Marker::centre_m, "m", "of the sphere").needed(),
      field("radius_m", &Marker::radius_m, "m", "of the sphere").positive(),
      field("covariance_m2", &Marker::covariance_m2, "m^2", "of the centre, 3 x 3, row by row"),
      sigma_field(&Marker::sigma),
      field("cover", &Marker::cover, "", "share of the sphere's directions that show its surface").range(0, 1),
      field("seen_in", &Marker::seen_in, "", "images that show it"),
      field("pixel", &Marker::pixel, "px", "where they show its centre: [x, y] for each of seen_in")};
  return table;
}

GONIO_RECORD(IndexMap, index_map_fields);
GONIO_RECORD(VolumeStep, volume_step_fields);
GONIO_RECORD(Volume, volume_fields);
GONIO_RECORD(Marker, marker_fields);

}  // namespace gonio::manifest
