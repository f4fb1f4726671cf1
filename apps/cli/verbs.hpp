// The verbs of the program, one file each. Each returns the exit code; throws UsageError or InputError.
#pragma once

#include "options.hpp"

namespace sightline::cli {

int run_info(const InfoOptions& options);
int run_list(const ListOptions& options);
int run_generate(const GenerateOptions& options);
int run_walk(const WalkOptions& options);
int run_render(const RenderOptions& options);
int run_view(const ViewerOptions& options);
int run_explain(const ExplainOptions& options);
int run_compare(const CompareOptions& options);
int run_occluders(const OccludersOptions& options);
int run_raster_report(const RasterReportOptions& options);
int run_faces(const FacesOptions& options);
int run_bounds(const BoundsOptions& options);
int run_sigma(const SigmaOptions& options);
int run_detail(const DetailOptions& options);
int run_structures(const StructuresOptions& options);
int run_persistence(const PersistenceOptions& options);
int run_queries(const QueriesOptions& options);

}  // namespace sightline::cli
