#pragma once

#include "byre/playback/report/report.h"
#include "byre/slam/system/slam_impl.h"

namespace byre {

Report finish_report(const FinishResult& finishing);

}  // namespace byre
