// JSON messages of byre, written by web_messages.cc, web_run.cc and web_map.cc in src/byre/viewer/web; those of a
// registry by src/byre/registry/listing.cc and src/byre/cli/registry/review_site.cc.

/** x, y, z in metres and quaternion x, y, z, w. */
export type PoseFields = [number, number, number, number, number, number, number];
export type Vector3Fields = [number, number, number];
export type Vector2Fields = [number, number];

export type Verdict = "trusted" | "degraded" | "untrusted";

export interface CameraFields {
  width: number;
  height: number;
  focal: number;
  cx: number;
  cy: number;
  body_from_camera: PoseFields;
}

/** Steps are plan metres per pixel; top_left is the centre of the top left pixel, plan metres. */
export interface PlanFields {
  name: string;
  width: number;
  height: number;
  step_right: Vector2Fields;
  step_down: Vector2Fields;
  top_left: Vector2Fields;
}

/** plan_from_map: scale, then pose. */
export interface RegistrationFields {
  plan: string;
  scale: number;
  pose: PoseFields;
}

interface SceneBase {
  name: string;
  up_in_map: Vector3Fields | null;
  plan: PlanFields | null;
  registration: RegistrationFields | null;
}

export interface RunScene extends SceneBase {
  mode: "run";
  map: string | null;
  frames: number;
  camera: CameraFields;
}

/** Keyframe with a picture; time since the start of its recording. */
export interface PictureFields {
  keyframe: number;
  recording: string;
  time_s: number;
  width_of_view: number; // size of the area that it sees; 0 without a plan
}

/** keyframe, u, v: shares of its picture's width and height. */
export type PicturePixel = [number, number, number];

export interface MapScene extends SceneBase {
  mode: "map";
  is_metric: boolean;
  pictures: PictureFields[];
  output: string | null;
  tags: number; // surveyed ones, which are picks as well
  is_read_only: boolean; // version of a registry: no points are picked
  plan_note: string; // sentence on the origin of the plan, or on its absence
  next_step: string; // sentence with a command
  before: string | null; // name of the earlier version that it is compared with
}

export type SceneFields = RunScene | MapScene;

export interface RegistryScene {
  mode: "registry";
  name: string; // host and database
  account: string;
}

export interface SiteSummary {
  site: string;
  accepted: string | null; // id of a version
  proposed: number;
  open_sessions: number;
  jobs: number; // waiting or running
  failed_jobs: number;
}

export type VersionState = "proposed" | "accepted" | "retired";

interface VersionBase {
  id: string;
  state: VersionState;
  bytes: number;
  note: string;
  added_by: string;
  added_at: string;
  reviewed_by: string | null;
  reason: string | null;
}

export interface SessionFields {
  id: string;
  name: string;
  ran_on: string; // id of a version
  added_by: string;
}

export interface SiteFields {
  versions: (VersionBase & { parent: string | null })[];
  plans: { name: string; number: number; file: string; note: string; added_by: string; added_at: string }[];
  sessions: (SessionFields & { added_at: string })[];
  jobs: { id: number; kind: string; state: string; attempts: number; worker: string | null; message: string }[];
  robots: {
    account: string;
    runs: string;
    refused: string;
    reason: string;
    waiting: number; // sessions that it has not sent
    seen_at: string | null;
  }[];
}

export interface EventFields {
  at: string;
  actor: string;
  kind: string;
  subject?: string; // id of a version or session, name of a plan, number of a job; not in VersionFields
  reason: string;
}

export type ReviewAct = "accept" | "reject" | "rollback";

/** refusal: why the review is not permitted now, or empty; version: the one that it accepts or rejects. */
export interface ReviewTrial {
  version: string;
  refusal: string;
}

export interface VersionFields extends VersionBase {
  parents: string[];
  sessions: SessionFields[];
  events: EventFields[];
  reviews: Record<ReviewAct, ReviewTrial>;
}

export interface FrameFields {
  time_s: number;
  state: string;
  verdict: Verdict;
  doubt: string;
  advice?: string; // what to do about the doubt
  pose: PoseFields | null;
  offline_inliers: number;
  offline_expected: number;
  online_inliers: number;
  expected: number;
  matches: number;
  features: number;
  suspended: number;
  inlier_share: number;
  spread: number;
  sigma_mm: number;
  since_offline_m: number;
  track_ms: number;
  online_keyframes: number;
  online_points: number;
  disagreement_mm?: number;
  events?: string[];
}

export interface LiveMessage {
  frames?: FrameFields[];
  online_map?: number;
  ended?: boolean;
}

/** A map point, the robot at a keyframe, a place in pictures, or with plan_end the foot of a wall in one picture. */
export interface Pick {
  name: string;
  plan: Vector2Fields;
  point?: number;
  station?: number;
  pixels?: PicturePixel[];
  plan_end?: Vector2Fields;
}

/** Place at which a further pick reduces the uncertainty most; sigmas: mean along the path. */
export interface NextPick {
  plan: Vector2Fields;
  pixels: PicturePixel[];
  sigma_before_m: number;
  sigma_after_m: number;
}

export interface PlanFit {
  registration: RegistrationFields;
  rms_m: number;
  residual_m: number; // root mean square; over all picks if the outliers may be correct
  is_far_off: boolean; // saving requires confirmation of the residual
  residuals: { error_m: Vector2Fields; sigma_m: number; is_outlier: boolean }[]; // of picks, then of tags
  doubts: string[];
  next?: NextPick | null;
}

/** Registration by the walls alone. doubt: why it must not be trusted. */
export interface Proposal extends PlanFit {
  description: string;
  doubt: string | null;
}
