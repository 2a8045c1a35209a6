// SPDX-License-Identifier: Apache-2.0
//
// The review requests of a site, work/requests.jsonl: one JSON object a line, the first one describes the file. Form in
// README.md.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "formats/provenance.h"
#include "survey/accuracy/certificate.h"
#include "survey/review/edit_request.h"
#include "survey/review/request_list.h"

namespace formats {

struct ListedReference {
  survey::StampNs stamp_ns = 0;
  survey::Pose2 site_from_scan;
  bool earlier_pass = false;
};

struct ListedAnswer {
  std::string file;  // relative to blocks/
  survey::Decision decision = survey::Decision::kSkip;
  survey::StampNs stamp_ns = 0;
};

// Where a scan may lie. Points in the frames of their scans.
struct ListedPose {
  survey::StampNs stamp_ns = 0;
  survey::StampNs from_ns = 0;
  survey::StampNs until_ns = 0;
  survey::Pose2 estimate;
  std::optional<survey::PoseSpread> spread;
  std::vector<survey::PoseMode> modes;
  std::optional<ListedReference> reference;
  std::vector<Eigen::Vector2f> points;
  std::vector<Eigen::Vector2f> reference_points;
  std::optional<ListedAnswer> answer;
};

// A request with everything that a page needs to show it.
struct ListedRequest {
  std::string id;
  std::string block;
  std::vector<survey::RequestCause> causes;
  double score_m = 0.0;
  std::string picture;  // relative to the list
  std::variant<ListedPose, survey::AppliedEdit> subject;

  bool IsAnswered() const {
    const ListedPose* pose = std::get_if<ListedPose>(&subject);
    return pose != nullptr && pose->answer.has_value();
  }
};

struct ListedBlock {
  std::string name;
  bool tied = false;
  std::string crs;
  std::string map;  // relative to the list
  survey::BlockReview review;
};

struct RequestList {
  std::vector<ListedBlock> blocks;
  std::vector<ListedRequest> requests;  // in their order of rank
};

// "B1-1048200000000-contradiction", "B1-3f1c9a6e02b7-edit_review". `what`: stamp of the scan or uid of the edit.
std::string IdOfRequest(const std::string& block, const std::string& what, const std::string& cause);

// Open ones first, then by score, block and stamp.
void Rank(std::vector<ListedRequest>* requests);

void WriteRequests(const std::filesystem::path& file, const RequestList& list, const Provenance& provenance);

// What the list says of each block. DataError when the file is no whole list.
std::vector<ListedBlock> ReadReviewedBlocks(const std::filesystem::path& file);

}  // namespace formats
