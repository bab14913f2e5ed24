(* Theorem 1 for a drivetrain that is late and not exact: the induction over periods, with plans as Driven.v has them. *)
Require Import Reals Lra Lia Psatz List.
From Coquelicot Require Import Coquelicot.
Require Import Contract Shipped Motion Reach Lag Drive Departs Clears Driven Statement Ego Plan Apart Entry Shield Pair.
Open Scope R_scope.

(** * The theorem *)

(* The contract as others, gaps and entries know it: with what the ego certainly does not exceed. Late is only the drivetrain. *)
Definition bounding (k : drivetrain) : contract := {|
  period := period k; latency := 0; jitter := 0;
  position_error := position_error k; speed_error := speed_error k; slack := slack k;
  ego_max_speed := ego_max_speed k; ego_acceleration := strongest k (ego_acceleration k);
  ego_go := strongest k (ego_go k); ego_braking := strongest k (ego_braking k);
  other_max_speed := other_max_speed k; other_acceleration := other_acceleration k; other_braking := other_braking k;
  follower_reaction := follower_reaction k; follower_braking := follower_braking k; precedence_braking := precedence_braking k |}.

(* A1 to A4 and A8 with a drivetrain. *)
Record valid_driven (k : drivetrain) : Prop := {
  bounds_valid : valid (bounding k);
  can_drive : drivable k;
  acceleration_pos : 0 <= ego_acceleration k;
  go_achieved : 0 < weakest k (ego_go k);
  go_commanded : ego_go k <= ego_acceleration k;
  emergency_no_weaker : ego_braking k <= ego_emergency k;
  goes_at : 0 < unlimited_driven k
}.

Section Ego.
Variables (k : drivetrain) (theta : R) (s v x pull : R -> R) (tau c : nat -> R) (ego : nat -> own).

Let B := bounding k.

Section Zone.
Variables (t w : R -> R) (b : nat -> bounds) (z : zone) (claimed : nat -> Prop) (since : nat).

(* Something was checked of the plan in force at call i: at call S j, since which it is carried on. What is checked is about the
   call, the departure, the periods of go, and whether the slowest ego does not come to a stand before it goes, and go is not
   reduced. *)
Definition in_force_driven (checked : nat -> departs -> nat -> Prop -> Prop) (i : nat) :=
  exists j count n parts late_, (since <= S j)%nat /\ i = (S j + count)%nat /\
    carried k theta s v x pull tau c j n count (own_v (ego (S j))) parts late_ /\
    checked (S j) (departure_driven k (own_v (ego (S j))) late_ parts (c (S j))) n
      (Departs.goes_on (unlimited_driven k) (fades k) (standing k parts (c (S j)))
         (start (own_v (ego (S j)) - speed_error k)) (legs_down k (c (S j)) late_ parts) /\
       forall q, (q < count)%nat -> (q < n)%nat -> c (S (S j) + q)%nat = ego_go k).

Definition stops_driven (d : departs) (n : nat) (limit : R) := 0 <= stops_short B limit (rests_driven k d n).

Definition in_time_driven (d : departs) (n : nat) (target : R) :=
  fst (clearing_driven k (least d) target) <= shortest_period k + INR n * period k.

(* D8 *)
Definition passes_driven (i : nat) (d : departs) (n : nat) :=
  let target := s_out z - own_s (ego i) + 3 * position_error k in
  let clears := fst (clearing_driven k (least d) target) in
  in_time_driven d n target /\ 0 <= clears_before B (t_in z - t_most (b i)) (rush B (w_most (b i)) clears).

Definition enters_driven (i : nat) (d : departs) (n : nat) :=
  let target := s_in z - own_s (ego i) + 3 * position_error k in
  let (clears, fast) := clearing_driven k (least d) target in
  let rushed := rush B (w_most (b i)) clears in
  in_time_driven d n target /\
  0 <= enters_ahead B (gap_ahead z (ego i) (b i)) rushed (safe_gap_driven k (speed rushed) fast).

(* D12 *)
Definition verified_driven (i : nat) (d : departs) (n : nat) (moves_on : Prop) :=
  stops_driven d n (stop_limit B z (ego i)) \/
  if lane z then stops_driven d n (behind B z (ego i) (b i)) \/ (moves_on /\ enters_driven i d n)
  else moves_on /\ passes_driven i d n.

(* D6, D9, D13 *)
Definition over_driven (i : nat) := s_out z <= own_least (ego i) \/ t_out z <= t_least (b i).

Definition ahead_driven (i : nat) :=
  s_in z <= own_least (ego i) /\ (lead_from z + lead_to z) / 2 <= own_s (ego i) - (t_most (b i) - position_error k).

Definition settles_driven (i : nat) :=
  lane z = true /\ ahead_driven i /\
  ((exists i', i = S i' /\ in_force_driven (fun j d n moves_on => moves_on /\ enters_driven j d n) i') \/
   safe_gap_driven k (w_most (b i)) (Rmax (own_v (ego i) - speed_error k) 0) <= gap_ahead z (ego i) (b i) \/
   i = since).

Definition judged_driven (i : nat) :=
  over_driven i \/ (exists i0, (since <= i0 <= i)%nat /\ settles_driven i0) \/ in_force_driven verified_driven i \/
  in_force_driven (fun j _ _ _ => opened_at B b z claimed j) i.

(* C7 *)
Definition gives_way_driven :=
  forall j i, (since <= S j <= i)%nat -> claimed (S j) ->
    rest_of {| distance := t (tau (S j)); speed := w (tau (S j)) |} (precedence_braking k) <= t_in z ->
    (exists n count parts late_, i = (S j + count)%nat /\
       carried k theta s v x pull tau c j n count (own_v (ego (S j))) parts late_) ->
    forall u, tau (S j) <= u <= tau (S i) -> t u <= t_in z \/ (lane z = true /\ lead_to z <= s u - t u).

(* The conditions on the ego: C3 to C5, A13, A16; on an other: C2, C3. *)
Record watches_driven : Prop := {
  contract_valid : valid_driven k;
  ego_moves : motion s v;
  ego_drives : drives k theta v x pull tau c;
  ego_held : goes_with (fun u => - v u) (fun u => - x u) (fun u => - pull u) (- unlimited_driven k);
  calls_on_grid : on_grid k tau;
  commands_in_range : forall i, - ego_braking k <= c i <= ego_acceleration k;
  ego_seen : forall i, (1 <= i)%nat -> own_holds B (ego i) (s (tau i)) (v (tau i));
  (* At first the ego brakes no harder than a command may lead to. *)
  first_acceleration : - (theta * strongest k (ego_braking k)) <= pull (tau since) - x (tau since);
  other_moves : motion t w;
  other_keeps : keeps_contract B w (tau since);
  other_seen : forall i, (since <= i)%nat -> known B t w (tau since) (tau i) (b i);
  first_call : (1 <= since)%nat
}.

(* And C6, C7, A9. *)
Record conditions : Prop := {
  watching : watches_driven;
  keeps_gap : lane z = true -> keeps_distance B z s v t w (tau since);
  first_gap : lane z = true -> ahead_driven since ->
    safe B z (s (tau since)) (v (tau since)) (t (tau since)) (w (tau since));
  gives_way_ : gives_way_driven
}.
End Zone.
End Ego.

(* Theorem 1 for a drivetrain: of an other whose zones cover every overlap with the ego, each judged at every call. *)
Definition Theorem1_driven := forall k theta s v x pull tau c ego t w b zones occupied claims since,
  cover zones occupied ->
  (forall z, In z zones -> conditions k theta s v x pull tau c ego t w b z (claims z) since /\
    forall i, (since <= i)%nat -> judged_driven k theta s v x pull tau c ego b z (claims z) since i) ->
  forall u, tau since <= u -> ~ occupied (s u) (t u).

(* Theorem 2 for drivetrains: two shielded vehicles that watch each other since before either was in a lane never are in it
   together. They may have different lags. C6, C7 and A9 are not assumed, nor is precedence used. *)
Definition Theorem2_driven := forall k theta s v x pull tau c ego b since theta' t w x' pull' tau' c' ego' b' since' z y,
  lane z = true -> lane y = true -> mirrored z y -> lead_from z < s_in z - t_in z < lead_to z ->
  watches_driven k theta s v x pull tau c ego t w b since ->
  watches_driven k theta' t w x' pull' tau' c' ego' s v b' since' ->
  (forall i, (since <= i)%nat -> judged_driven k theta s v x pull tau c ego b z (fun _ => False) since i) ->
  (forall i, (since' <= i)%nat -> judged_driven k theta' t w x' pull' tau' c' ego' b' y (fun _ => False) since' i) ->
  s (Rmax (tau since) (tau' since')) < s_in z -> t (Rmax (tau since) (tau' since')) < t_in z ->
  forall u, Rmax (tau since) (tau' since') <= u -> ~ inside z (s u) (t u).

Lemma safe_gap_driven_is k w v : safe_gap_driven k w v = safe_gap (bounding k) w v.
Proof. reflexivity. Qed.

Lemma unlimited_below k : valid_driven k -> unlimited_driven k <= unheld (bounding k).
Proof.
  intros [_ (p0 & l0 & j0 & _ & lag0 & [g0 g1] & d0 & go0 & b0) a0 _ _ eb _].
  assert (b1 : 0 <= ego_braking k).
  { destruct (Rle_lt_dec 0 (ego_braking k)) as [? | neg]; [assumption | exfalso]. unfold weakest in b0.
    assert (0 <= ego_gain k * Rmax (ego_braking k) (- ego_braking k)) by (apply Rmult_le_pos; [exact g0 | cases; lra]). lra. }
  assert (share : forall p, 0 <= p -> 0 <= ego_gain k * Rmax p (- p) + ego_disturbance k).
  { intros p p_. assert (0 <= ego_gain k * Rmax p (- p)) by (apply Rmult_le_pos; [exact g0 | cases; lra]). lra. }
  pose proof (share (ego_acceleration k) a0). pose proof (share (ego_emergency k) ltac:(lra)).
  assert (r0 : 0 <= response k) by (unfold response, switching; lra).
  assert (f0 : 0 <= (ego_disturbance k + ego_disturbance k) / (1 - ego_gain k))
    by (apply Rmult_le_pos; [lra | left; apply Rinv_0_lt_compat; lra]).
  unfold unlimited_driven, unheld, bounding, switching, strongest. cbn [ego_max_speed speed_error ego_acceleration ego_braking
    latency jitter ego_go period].
  set (f := (ego_disturbance k + ego_disturbance k) / (1 - ego_gain k)) in *.
  assert (0 <= f * period k) by (apply Rmult_le_pos; lra).
  set (e := ego_emergency k + (ego_gain k * Rmax (ego_emergency k) (- ego_emergency k) + ego_disturbance k)) in *.
  set (a := ego_acceleration k + (ego_gain k * Rmax (ego_acceleration k) (- ego_acceleration k) + ego_disturbance k)) in *.
  assert (0 <= (a + e) * response k) by (apply Rmult_le_pos; [unfold a, e; lra | exact r0]). lra.
Qed.

(** * The ego brakes no harder than its commands lead to *)

(* A lag does not make it brake harder than what is followed. *)
Lemma lag_brakes_no_harder theta (x pull : R -> R) q T : lags theta x pull -> 0 <= q ->
  (forall t1 t2, T <= t1 -> t1 <= t2 -> - q * (t2 - t1) <= pull t2 - pull t1) -> - (theta * q) <= pull T - x T ->
  forall t1 t2, T <= t1 -> t1 <= t2 -> x t1 - q * (t2 - t1) <= x t2.
Proof.
  intros [th0 once late_] q0 falls first.
  (* Its acceleration is -q at least, at every time. *)
  assert (still : forall u, T <= u -> x u <= pull u + theta * q).
  { intros u lo.
    pose proof (stays_below_line theta x pull (pull u + theta * q + q * (u - T)) (- q) T u th0
      (fun z r _ => once z r) (fun p r _ => late_ p r)) as L.
    replace (pull u + theta * q) with (pull u + theta * q + q * (u - T) + - q * (u - T)) by ring. apply L; [| | lra].
    - pose proof (falls T u ltac:(lra) lo). lra.
    - intros r h. pose proof (falls r u ltac:(lra) ltac:(lra)). lra. }
  intros t1 t2 lo le.
  assert (L : - x t2 <= - x t1 + q * (t2 - t1)); [| lra].
  apply (stays_below_line theta (fun u => - x u) (fun u => - pull u) (- x t1) q t1 t2 th0); [| | lra | | lra].
  - intros z r _. rewrite (once z r). reflexivity.
  - intros p r _. pose proof (is_derive_opp x r _ (late_ p r)) as D.
    replace ((- pull r - - x r) / theta) with (opp ((pull r - x r) / theta)); [exact D |]. unfold opp. cbn. field. lra.
  - intros u h. pose proof (falls t1 u lo ltac:(lra)). pose proof (still t1 lo). lra.
Qed.

(** * A plan that is carried on *)

Section Zone.
Variables (k : drivetrain) (theta : R) (s v x pull : R -> R) (tau c : nat -> R) (ego : nat -> own).
Variables (t w : R -> R) (b : nat -> bounds) (z : zone) (claimed : nat -> Prop) (since : nat).
Hypothesis holds_ : watches_driven k theta s v x pull tau c ego t w b since.

Notation B := (bounding k).
Let ok : valid_driven k := contract_valid _ _ _ _ _ _ _ _ _ _ _ _ _ holds_.
Let okB : valid B := bounds_valid k ok.
Let ms : motion s v := ego_moves _ _ _ _ _ _ _ _ _ _ _ _ _ holds_.
Let mt : motion t w := other_moves _ _ _ _ _ _ _ _ _ _ _ _ _ holds_.
Let grid : on_grid k tau := calls_on_grid _ _ _ _ _ _ _ _ _ _ _ _ _ holds_.
Let keeps : keeps_contract B w (tau since) := other_keeps _ _ _ _ _ _ _ _ _ _ _ _ _ holds_.
Let start_ : (1 <= since)%nat := first_call _ _ _ _ _ _ _ _ _ _ _ _ _ holds_.

Lemma in_order i j : (i <= j)%nat -> tau i <= tau j.
Proof.
  destruct grid as [g0 G]. induction 1 as [| j le IH]; [lra |].
  pose proof (G j) as Gj. pose proof (G (S j)) as Gs. rewrite S_INR in Gs.
  destruct (can_drive k ok) as (_ & _ & j0 & sp & _). unfold shortest_period in sp. lra.
Qed.

Lemma where_driven i : (1 <= i)%nat -> own_holds B (ego i) (s (tau i)) (v (tau i)).
Proof. apply (ego_seen _ _ _ _ _ _ _ _ _ _ _ _ _ holds_). Qed.

Lemma what_driven i : (since <= i)%nat -> hold (b i) (t (tau i)) (w (tau i)).
Proof. intros h. apply (known_holds B t w (tau since)); auto. apply (other_seen _ _ _ _ _ _ _ _ _ _ _ _ _ holds_ i h). Qed.

Lemma keeps_since i : (since <= i)%nat -> keeps_contract B w (tau i).
Proof. intros h. apply keeps_later with (tau since); [apply in_order, h | exact keeps]. Qed.

Lemma hard_braking : 0 < strongest k (ego_braking k) <= other_braking k.
Proof. split; [exact (ego_braking_pos B okB) | exact (A1 B okB)]. Qed.

Lemma sure_braking : 0 < weakest k (ego_braking k) <= other_braking k.
Proof.
  destruct (can_drive k ok) as (_ & _ & _ & _ & _ & [g0 _] & d0 & _ & b0). split; [exact b0 |].
  pose proof hard_braking. unfold strongest, weakest in *.
  assert (0 <= ego_gain k * Rmax (ego_braking k) (- ego_braking k)); [| lra].
  apply Rmult_le_pos; [exact g0 |]. cases; lra.
Qed.

(* C5, C6: from the first call on it slows at the hardest braking that a plan commands, as achieved, at most. *)
Lemma gentle_driven p q : tau since <= p -> p <= q -> v p - strongest k (ego_braking k) * (q - p) <= v q.
Proof.
  intros lo le. pose proof hard_braking as [h0 _].
  pose proof (ego_drives _ _ _ _ _ _ _ _ _ _ _ _ _ holds_) as drive.
  assert (falls : forall t1 t2, tau since <= t1 -> t1 <= t2 -> - strongest k (ego_braking k) * (t2 - t1) <= pull t2 - pull t1).
  { intros t1 t2 l1 l2. apply (pulls_down k theta v x pull tau c drive); [| exact l2 |].
    - apply Rle_trans with (2 := l1). apply in_order, start_.
    - intros j _ _. pose proof (commands_in_range _ _ _ _ _ _ _ _ _ _ _ _ _ holds_ j) as [r _].
      destruct (can_drive k ok) as (_ & _ & _ & _ & _ & [g0 g1] & d0 & _). unfold strongest, weakest.
      assert (ego_gain k * Rmax (c j) (- c j) - ego_gain k * Rmax (ego_braking k) (- ego_braking k) <= c j + ego_braking k); [| lra].
      rewrite <- Rmult_minus_distr_l.
      assert (Rmax (c j) (- c j) - Rmax (ego_braking k) (- ego_braking k) <= c j + ego_braking k) by (cases; lra).
      destruct (Rle_lt_dec 0 (Rmax (c j) (- c j) - Rmax (ego_braking k) (- ego_braking k))) as [pos | neg]; nra. }
  pose proof (lag_brakes_no_harder theta x pull _ (tau since) (follows k theta v x pull tau c drive) (Rlt_le _ _ h0) falls
                (first_acceleration _ _ _ _ _ _ _ _ _ _ _ _ _ holds_)) as L.
  destruct (ego_held _ _ _ _ _ _ _ _ _ _ _ _ _ holds_ p q le) as [D | (y & [y1 y2] & _ & _ & _ & D)].
  - pose proof (L p q lo le). lra.
  - pose proof (L y q ltac:(lra) y2). assert (strongest k (ego_braking k) * (q - y) <= strongest k (ego_braking k) * (q - p))
      by (apply Rmult_le_compat_l; lra). lra.
Qed.

Lemma clears_later r target : 0 <= fst (clearing_driven k r target).
Proof.
  pose proof (goes_at k ok) as cap0. pose proof (go_achieved k ok) as g0.
  destruct (can_drive k ok) as (_ & l0 & j0 & sp & lag0 & _).
  set (f := fading r (unlimited_driven k) (fades k * (Rmax (target - distance r) 0 / unlimited_driven k))).
  set (u0 := until {| distance := distance f; speed := Rmax (speed f) 0 |} target (weakest k (ego_go k)) (unlimited_driven k)).
  change (fst (clearing_driven k r target)) with (Rmax 0 (- speed f) / weakest k (ego_go k) + fst u0 + shortest_period k + response k).
  assert (div : forall p q, 0 <= p -> 0 < q -> 0 <= p / q) by (intros; apply Rmult_le_pos; [lra | left; apply Rinv_0_lt_compat; lra]).
  assert (0 <= Rmax 0 (- speed f) / weakest k (ego_go k)) by (apply div; [apply Rmax_l | exact g0]).
  assert (0 <= fst u0).
  { unfold u0, until. cbn [fst]. apply Rplus_le_le_0_compat; apply div; try apply Rmax_r; try exact g0.
    apply Rlt_le_trans with (1 := cap0). apply Rmax_l. }
  assert (0 <= response k) by (unfold response, switching; lra). lra.
Qed.

Section Carried.
Variables (j n count : nat) (parts : list part) (late_ : bool).
Hypothesis from : (since <= S j)%nat.
Hypothesis carried_ : carried k theta s v x pull tau c j n count (own_v (ego (S j))) parts late_.
Let T := tau (S j).
Let E := tau (S (S j + count)).
Notation o := (ego (S j)).
Let d := departure_driven k (own_v o) late_ parts (c (S j)).

Lemma here : own_holds B o (s T) (v T).
Proof. apply where_driven. lia. Qed.

Lemma them : hold (b (S j)) (t T) (w T).
Proof. apply what_driven, from. Qed.

Lemma place_of_rest u : T <= u <= E ->
  s u - s T + v u * v u / (weakest k (ego_braking k) + weakest k (ego_braking k)) <= rests_driven k d n.
Proof. intros h. apply (plan_of_a_drivetrain_stops k theta s v x pull tau c j n count (own_v o) parts late_ carried_ u h). Qed.

Lemma no_farther u : T <= u <= E -> s u - s T <= rests_driven k d n.
Proof.
  intros h. pose proof (place_of_rest u h). pose proof sure_braking.
  assert (0 <= v u * v u / (weakest k (ego_braking k) + weakest k (ego_braking k))); [| lra].
  apply Rmult_le_pos; [apply Rle_0_sqr | left; apply Rinv_0_lt_compat; lra].
Qed.

Lemma before_limit u : stops_driven k d n (stop_limit B z o) -> T <= u <= E -> s u < s_in z.
Proof.
  intros st h. destruct here as (sT & _). unfold stops_driven, stops_short, stop_limit in st.
  pose proof (no_farther u h). pose proof (slack_pos B okB). lra.
Qed.

Lemma behind_driven u : stops_driven k d n (behind B z o (b (S j))) -> T <= u <= E -> s u - t u <= lead_from z.
Proof.
  intros st h. destruct here as (sT & _). destruct them as [tT wT].
  change (stops_driven k d n (behind B z o (b (S j)))) with (0 <= stops_short B (behind B z o (b (S j))) (rests_driven k d n)) in st.
  unfold stops_short, behind in st. pose proof (slack_pos B okB).
  pose proof (no_farther T ltac:(lra)) as R0.
  destruct (Rlt_dec _ 0) as [not_behind | is_behind]; [lra |].
  set (gap := lead_from z - (own_s o + position_error B - t_least (b (S j)))) in *.
  rewrite earliest_rest_is in st. unfold rest_of, start in st. cbn [distance speed] in st.
  set (W := Rmax (w_least (b (S j))) 0) in *.
  assert (W0 : 0 <= W <= w T).
  { pose proof (forwards t w mt T). unfold W. cases; lra. }
  assert (s u - t u <= s T - t T + gap); [| unfold gap in *; lra].
  pose proof hard_braking. pose proof sure_braking.
  apply (stays_behind B (strongest k (ego_braking k)) (weakest k (ego_braking k)) s v t w T E (rests_driven k d n) gap W); auto; try lra.
  - apply H0.
  - apply keeps_since, from.
  - intros p q ? ? ?. apply gentle_driven; [apply Rle_trans with T; [apply in_order, from |] |]; lra.
  - intros. apply place_of_rest. lra.
Qed.

Let on_the_way := Departs.goes_on (unlimited_driven k) (fades k) (standing k parts (c (S j)))
  (start (own_v o - speed_error k)) (legs_down k (c (S j)) late_ parts) /\
  forall q, (q < count)%nat -> (q < n)%nat -> c (S (S j) + q)%nat = ego_go k.

Lemma clears_driven target : on_the_way -> in_time_driven k d n target ->
  let clears := fst (clearing_driven k (least d) target) in
  let fast := snd (clearing_driven k (least d) target) in
  0 <= fast /\ (T + clears <= E -> target <= s (T + clears) - s T) /\
  forall u, T <= u <= E -> u <= T + clears -> grows B (v u) fast (T + clears - u).
Proof.
  intros [moves_on unreduced] it.
  pose proof (commands_in_range _ _ _ _ _ _ _ _ _ _ _ _ _ holds_ (S j)) as [_ a1].
  destruct (can_drive k ok) as (_ & _ & _ & _ & _ & [g0 g1] & d0 & _).
  pose proof (acceleration_pos k ok) as a0. pose proof (go_commanded k ok) as ga.
  assert (up : forall p, p <= ego_acceleration k -> weakest k p <= strongest k (ego_acceleration k)).
  { intros p le. unfold weakest, strongest.
    assert (0 <= ego_gain k * Rmax p (- p)) by (apply Rmult_le_pos; [exact g0 | cases; lra]).
    assert (0 <= ego_gain k * Rmax (ego_acceleration k) (- ego_acceleration k)) by (apply Rmult_le_pos; [exact g0 | cases; lra]). lra. }
  assert (m0 : 0 <= strongest k (ego_acceleration k)) by exact (Rlt_le _ _ (ego_acceleration_pos B okB)).
  destruct (plan_of_a_drivetrain_clears k theta s v x pull tau c j n count (own_v o) parts late_ carried_ target
              (strongest k (ego_acceleration k)) moves_on unreduced (up _ a1) (up _ ga) m0 it) as [gone slow].
  cbn zeta. split; [| split; [exact gone |]].
  - apply sqrt_pos.
  - intros u hu le. destruct (slow u hu le) as [s1 s2]. split; [exact s1 |].
    apply Rle_trans with (1 := s2). apply Rmax_lub; [| apply Rmax_r].
    apply Rle_trans with (2 := Rmax_l _ _). apply unlimited_below, ok.
Qed.

Lemma passing_driven u : on_the_way -> passes_driven k ego b z (S j) d n -> T <= u <= E -> ~ inside z (s u) (t u).
Proof.
  intros way [it spare] [lo hi] ((_ & sout) & (tin & _) & _).
  destruct here as (sT & _). destruct them as [tT wT].
  pose proof (position_error_nonneg B okB). change (position_error B) with (position_error k) in *.
  destruct (clears_driven _ way it) as (_ & gone & _).
  set (clears := fst (clearing_driven k (least d) (s_out z - own_s o + 3 * position_error k))) in *.
  destruct (Rle_dec u (T + clears)) as [early | late].
  - pose proof (has_not_arrived B t w T u clears (t_in z - t_most (b (S j))) (w_most (b (S j))) (t_most (b (S j))) okB mt
      (keeps_since _ from) lo early ltac:(lra) ltac:(lra) spare). lra.
  - specialize (gone ltac:(lra)). pose proof (advances s v (T + clears) u ms ltac:(lra)). lra.
Qed.

Lemma entering_driven u : on_the_way -> enters_driven k ego b z (S j) d n -> T <= u <= E -> s_in z <= s u ->
  exists y, T <= y <= u /\ s_in z <= s y /\ safe B z (s y) (v y) (t y) (w y).
Proof.
  intros way en [lo hi] inn. unfold enters_driven in en.
  destruct here as (sT & vT & least_). destruct them as [tT wT].
  assert (eps : 0 <= position_error k) by exact (position_error_nonneg B okB).
  change (position_error B) with (position_error k) in *.
  assert (a0 : 0 < other_acceleration B) by exact (other_acceleration_pos B okB).
  set (target := s_in z - own_s o + 3 * position_error k) in *.
  assert (it : in_time_driven k d n target) by (destruct (clearing_driven k (least d) target); apply en).
  destruct (clears_driven target way it) as (V0 & gone & slow). pose proof (clears_later (least d) target) as c0.
  destruct (clearing_driven k (least d) target) as [clears V] eqn:cl. cbn [fst snd] in *. destruct en as [_ spare].
  rewrite safe_gap_driven_is in spare.
  assert (entry : exists y, T <= y <= u /\ y <= T + clears /\ Rmax (s_in z) (own_least o) <= s y).
  { destruct (Rle_lt_dec u (T + clears)) as [early | late].
    - destruct (Rle_dec (s_in z) (s T)) as [within | before].
      + exists T. split; [lra |]. split; [lra |]. apply Rmax_lub; lra.
      + rewrite Rmax_left by lra. destruct (Motion.passes s v T u (s_in z) ms lo ltac:(lra)) as (y & ? & e). exists y. lra.
    - specialize (gone ltac:(lra)). unfold target in gone.
      destruct (Rle_dec (s_in z) (s T)) as [within | before].
      + exists T. split; [lra |]. split; [lra |]. apply Rmax_lub; lra.
      + rewrite Rmax_left by lra.
        destruct (Motion.passes s v T (T + clears) (s_in z) ms ltac:(lra) ltac:(lra)) as (y & ? & e). exists y. lra. }
  destruct entry as (y & [y1 y2] & y3 & at_).
  pose proof (Rmax_l (s_in z) (own_least o)).
  exists y. split; [lra |]. split; [lra |].
  pose proof (entry_sooner B (w_most (b (S j))) (gap_ahead z o (b (S j))) clears (y - T) (v y) V okB ltac:(lra)
    (forwards s v ms y) V0) as G.
  replace (clears - (y - T)) with (T + clears - y) in G by ring.
  specialize (G (slow y ltac:(lra) y3) spare).
  destruct (rushing_holds t w (t T) (other_acceleration B) (other_max_speed B) (start (w_most (b (S j)))) T y mt a0 y1)
    as [B1 B2].
  { intros p q ? ? ?. apply (rushes B w T (keeps_since _ from) y); lra. }
  { cbn. lra. }
  { cbn. cases; lra. }
  rewrite <- rush_is in B1, B2.
  pose proof (safe_gap_monotone B (w y) _ (v y) (v y) okB B2 (forwards s v ms y) (Rle_refl _)) as M.
  pose proof (slack_pos B okB). unfold gap_ahead in G. unfold safe. lra.
Qed.
End Carried.

(* [first_gap_] is of an ego that is ahead in the lane from the beginning. *)
Section Settled.
Hypothesis first_gap_ : lane z = true -> ahead_driven k ego b z since ->
  safe B z (s (tau since)) (v (tau since)) (t (tau since)) (w (tau since)).

Hypothesis judges : forall i, (since <= i)%nat -> judged_driven k theta s v x pull tau c ego b z claimed since i.

Lemma settles_well i : (since <= i)%nat -> settles_driven k theta s v x pull tau c ego b z since i ->
  exists y, tau since <= y <= tau i /\ s_in z <= s y /\ safe B z (s y) (v y) (t y) (w y).
Proof.
  intros h (la & [inn half] & why). destruct (where_driven i ltac:(lia)) as (sT & vT & least_). destruct (what_driven i h) as [tT wT].
  pose proof (in_order since i h) as lo.
  destruct why as [(i' & -> & j & count & n & parts & late_ & from & -> & car & way & en) | [gap | ->]].
  - destruct (entering_driven j n count parts late_ from car (tau (S (S j + count))) way en) as (y & [y1 y2] & ? & ?).
    + split; [apply in_order; lia | lra].
    + lra.
    + exists y. split; [| auto]. split; [| lra]. apply Rle_trans with (tau (S j)); [apply in_order, from | lra].
  - exists (tau i). split; [lra |]. split; [lra |]. unfold safe. rewrite safe_gap_driven_is in gap.
    pose proof (forwards s v ms (tau i)). change (speed_error B) with (speed_error k) in *.
    pose proof (safe_gap_monotone B (w (tau i)) (w_most (b i)) (v (tau i)) (Rmax (own_v (ego i) - speed_error k) 0) okB
      ltac:(lra) (Rmax_r _ _) ltac:(cases; lra)).
    unfold gap_ahead in gap.
    assert (Rmax (s_in z) (own_least (ego i)) <= s (tau i)) by (apply Rmax_lub; lra). lra.
  - exists (tau since). split; [lra |]. split; [lra |].
    apply (first_gap_ la). split; assumption.
Qed.

(* Who has no precedence is before the lane, or behind, or one of both has left; or it leads, or has led. *)
Lemma outcome_driven u : lane z = true -> (forall i, ~ claimed i) -> s (tau since) < s_in z -> tau since <= u ->
  s u < s_in z \/ s u - t u <= lead_from z \/ s_out z <= s u \/ t_out z <= t u \/
  exists y, tau since <= y <= u /\ s_in z <= s y /\ lead_to z <= s y - t y.
Proof.
  intros la none before lo0.
  assert (gap_open : forall y, safe B z (s y) (v y) (t y) (w y) -> lead_to z <= s y - t y).
  { intros y sf. unfold safe in sf. rewrite safe_gap_is in sf.
    pose proof (Rmax_r (rest_of (rush B (w y) (follower_reaction B)) (follower_braking B) - rest_of (start (v y)) (hardest B)) 0). lra. }
  destruct (between k tau since u (period_pos B okB) grid (in_order since (S since) ltac:(lia)) lo0) as (i & h & [lo hi]).
  destruct (where_driven i ltac:(lia)) as (sT & vT & least_). destruct (what_driven i h) as [tT wT].
  destruct (judges i h) as [[past | past] | [(i0 & [r1 r2] & se) | [(j & count & n & parts & late_ & from & -> & car & ver)
    | (j & count & n & parts & late_ & from & -> & car & cl & _)]]].
  - right; right; left. pose proof (advances s v (tau i) u ms lo). lra.
  - do 3 right; left. pose proof (advances t w (tau i) u mt lo). lra.
  - do 4 right. destruct (settles_well i0 r1 se) as (y & [y1 y2] & inn & gap). pose proof (in_order i0 i r2).
    exists y. split; [lra |]. split; [exact inn | apply gap_open, gap].
  - assert (hu : tau (S j) <= u <= tau (S (S j + count))).
    { split; [apply Rle_trans with (tau (S j + count)%nat); [apply in_order; lia | lra] | lra]. }
    destruct ver as [st | other_way]; [left; exact (before_limit j n count parts late_ from car u st hu) |].
    rewrite la in other_way. destruct other_way as [st | [way en]].
    + right; left. exact (behind_driven j n count parts late_ from car u st hu).
    + destruct (Rlt_le_dec (s u) (s_in z)) as [out | inn]; [left; exact out |]. do 4 right.
      destruct (entering_driven j n count parts late_ from car u way en hu inn) as (y & [y1 y2] & inn' & gap).
      exists y. split; [| split; [exact inn' | apply gap_open, gap]].
      split; [apply Rle_trans with (tau (S j)); [apply in_order, from | lra] | lra].
  - destruct (none _ cl).
Qed.

Hypothesis gap_kept : lane z = true -> keeps_distance B z s v t w (tau since).
Hypothesis gives : gives_way_driven k theta s v x pull tau c ego t w z claimed since.

(* Once the gap is safe in the lane, it stays open. *)
Lemma settled_for_good y u : lane z = true -> tau since <= y -> y <= u -> s_in z <= s y ->
  safe B z (s y) (v y) (t y) (w y) -> ~ inside z (s u) (t u).
Proof.
  intros la lo le inn gap ((_ & sout) & (_ & tout) & _ & lead).
  destruct (gap_kept la y u lo le inn gap sout tout) as (y' & [y1 y2] & gap' & react).
  assert (lead_to z <= s u - t u); [| lra].
  apply (stays_ahead B s v t w z y' u); auto.
  - intros p q ? ? ?. apply (rushes B w _ keeps u); lra.
  - intros p q ? ? ?. apply gentle_driven; lra.
Qed.

Lemma never_inside u : tau since <= u -> ~ inside z (s u) (t u).
Proof.
  intros lo0.
  destruct (between k tau since u (period_pos B okB) grid (in_order since (S since) ltac:(lia)) lo0) as (i & h & [lo hi]).
  destruct (where_driven i ltac:(lia)) as (sT & vT & least_). destruct (what_driven i h) as [tT wT].
  destruct (judges i h) as [[past | past] | [(i0 & [r1 r2] & se) | [(j & count & n & parts & late_ & from & -> & car & ver)
    | (j & count & n & parts & late_ & from & -> & car & cl & stop)]]].
  - intros ((_ & ?) & _). pose proof (advances s v (tau i) u ms lo). lra.
  - intros (_ & (_ & ?) & _). pose proof (advances t w (tau i) u mt lo). lra.
  - destruct (settles_well i0 r1 se) as (y & [y1 y2] & inn & gap). pose proof (in_order i0 i r2).
    apply (settled_for_good y u); auto; [apply se | lra].
  - assert (hu : tau (S j) <= u <= tau (S (S j + count))).
    { split; [apply Rle_trans with (tau (S j + count)%nat); [apply in_order; lia | lra] | lra]. }
    destruct ver as [st | other_way].
    { intros [[? _] _]. pose proof (before_limit j n count parts late_ from car u st hu). lra. }
    assert (which : lane z = true \/ lane z = false) by (destruct (lane z); auto).
    destruct which as [la | la]; rewrite la in other_way; [destruct other_way as [st | [way en]] | destruct other_way as [way pa]].
    + intros (_ & _ & [? _]). pose proof (behind_driven j n count parts late_ from car u st hu). lra.
    + intros ins. destruct (entering_driven j n count parts late_ from car u way en hu ltac:(destruct ins as [[? _] _]; lra))
        as (y & [y1 y2] & inn & gap).
      refine (settled_for_good y u la _ y2 inn gap ins). apply Rle_trans with (tau (S j)); [apply in_order, from | lra].
    + exact (passing_driven j n count parts late_ from car u way pa hu).
  - destruct (what_driven (S j) from) as [tS wS]. pose proof (forwards t w mt (tau (S j))) as w0.
    intros (_ & [tin _] & [_ led]).
    assert (t u <= t_in z \/ (lane z = true /\ lead_to z <= s u - t u)); [| lra].
    apply (gives j (S j + count)%nat); auto; [lia | | | ].
    + apply Rle_trans with (2 := stop). unfold rest_of. cbn [distance speed].
      assert (p0 : 0 < precedence_braking k) by exact (precedence_braking_pos B okB).
      change (precedence_braking B) with (precedence_braking k).
      assert (w (tau (S j)) * w (tau (S j)) / (precedence_braking k + precedence_braking k)
          <= w_most (b (S j)) * w_most (b (S j)) / (precedence_braking k + precedence_braking k)); [| lra].
      apply Rmult_le_compat_r; [left; apply Rinv_0_lt_compat; lra | apply Rmult_le_compat; lra].
    + exists n, count, parts, late_. auto.
    + split; [apply Rle_trans with (tau (S j + count)%nat); [apply in_order; lia | lra] | lra].
Qed.
End Settled.
End Zone.

Theorem drivetrains_keep_apart : Theorem1_driven.
Proof.
  intros k theta s v x pull tau c ego t w b zones occupied claims since cov all u lo occ.
  destruct (cov (s u) (t u) occ) as (z & zin & ins). destruct (all z zin) as [[watching_ gap first gives] judges].
  exact (never_inside k theta s v x pull tau c ego t w b z (claims z) since watching_ first judges gap gives u lo ins).
Qed.

(** * Two *)

Theorem drivetrains_share_a_lane : Theorem2_driven.
Proof.
  intros k theta s v x pull tau c ego b since theta' t w x' pull' tau' c' ego' b' since' z y lz ly (m1 & m2 & m3 & m4 & m5 & m6) corner
    W W' J J' sb tb.
  set (T := Rmax (tau since) (tau' since')) in *.
  pose proof (Rmax_l (tau since) (tau' since')) as T1. pose proof (Rmax_r (tau since) (tau' since')) as T2. fold T in T1, T2.
  pose proof (ego_moves _ _ _ _ _ _ _ _ _ _ _ _ _ W) as ms. pose proof (ego_moves _ _ _ _ _ _ _ _ _ _ _ _ _ W') as mt.
  pose proof (advances s v (tau since) T ms T1). pose proof (advances t w (tau' since') T mt T2).
  assert (out : ~ ahead_driven k ego b z since).
  { intros [least_ _]. pose proof (where_driven _ _ _ _ _ _ _ _ _ _ _ _ _ W since (first_call _ _ _ _ _ _ _ _ _ _ _ _ _ W)) as (_ & _ & l). lra. }
  assert (out' : ~ ahead_driven k ego' b' y since').
  { intros [least_ _]. pose proof (where_driven _ _ _ _ _ _ _ _ _ _ _ _ _ W' since' (first_call _ _ _ _ _ _ _ _ _ _ _ _ _ W')) as (_ & _ & l).
    rewrite m1 in least_. lra. }
  apply (one_leads z s v t w T corner ms mt).
  - intros u h. destruct (outcome_driven k theta s v x pull tau c ego t w b z (fun _ => False) since W
      (fun _ a => match out a with end) J u lz (fun _ f => f) ltac:(lra) ltac:(lra)) as [? | [? | [? | [? | (q & hq & sq & lq)]]]]; auto.
    do 4 right. exists q. split; [| auto]. split; [| lra].
    destruct (Rle_dec T q) as [? | before]; [assumption | exfalso]. pose proof (advances s v q T ms ltac:(lra)). lra.
  - intros u h. destruct (outcome_driven k theta' t w x' pull' tau' c' ego' s v b' y (fun _ => False) since' W'
      (fun _ a => match out' a with end) J' u ly (fun _ f => f) ltac:(rewrite m1; lra) ltac:(lra)) as [? | [? | [? | [? | (q & hq & sq & lq)]]]].
    + left. lra.
    + right; left. lra.
    + do 2 right; left. lra.
    + do 3 right; left. lra.
    + do 4 right. exists q. rewrite m1 in sq. rewrite m6 in lq. split; [| split; lra]. split; [| lra].
      destruct (Rle_dec T q) as [? | before]; [assumption | exfalso]. pose proof (advances t w q T mt ltac:(lra)). lra.
Qed.
