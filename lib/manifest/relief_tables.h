// The field tables of the sections about heights (relief_sections.h) and the codecs that follow from them. Defined in
// relief_tables.cpp.
#pragma once
#include <vector>

#include "manifest/relief_sections.h"
#include "manifest/section_tables.h"

namespace gonio::manifest {

const std::vector<Field<ReliefTreatment>>& relief_treatment_fields();
const std::vector<Field<RoughnessFigure>>& roughness_figure_fields();
const std::vector<Field<NormalsFit>>& normals_fit_fields();
const std::vector<Field<ReliefLobe>>& relief_lobe_fields();
const std::vector<Field<ReliefMap>>& relief_map_fields();
const std::vector<Field<GroundNoisePart>>& ground_noise_part_fields();
const std::vector<Field<GroundNoiseFit>>& ground_noise_fields();

#define GONIO_RECORD(TYPE, TABLE)                                                                                 \
  template <>                                                                                                     \
  struct Codec<TYPE> {                                                                                            \
    static TYPE read(const Value& value, const std::string& place) { return read_record(value, TABLE(), place); } \
    static Value write(const TYPE& member) { return write_record(member, TABLE()); }                              \
    static Value schema() { return record_schema(TABLE()); }                                                      \
  }
GONIO_RECORD(ReliefTreatment, relief_treatment_fields);
GONIO_RECORD(RoughnessFigure, roughness_figure_fields);
GONIO_RECORD(NormalsFit, normals_fit_fields);
GONIO_RECORD(ReliefLobe, relief_lobe_fields);
GONIO_RECORD(ReliefMap, relief_map_fields);
GONIO_RECORD(GroundNoisePart, ground_noise_part_fields);
GONIO_RECORD(GroundNoiseFit, ground_noise_fields);
#undef GONIO_RECORD

}  // namespace gonio::manifest
