(* Controls of Theorem 4 in lanes: one enters a lane ahead of another that counts on precedence and brakes, too gently to stay
   behind. All else holds; only P7 does not, or lanes are judged as crossings are. *)
Require Import Reals Lra Lia Psatz List.
From Coquelicot Require Import Coquelicot.
Require Import Contract Shipped Motion Reach Statement Ego Controls Passage.
Open Scope R_scope.

(* Everybody brakes gently, but for followers. *)
Definition gentle_ : contract := {|
  period := 1; latency := 0; jitter := 0; position_error := 0; speed_error := 0; slack := 1 / 100;
  ego_max_speed := 10; ego_acceleration := 1; ego_go := 1; ego_braking := 1 / 10;
  other_max_speed := 10; other_acceleration := 1; other_braking := 4;
  follower_reaction := 0; follower_braking := 4; precedence_braking := 1 / 10 |}.

Lemma gentle_valid : valid gentle_.
Proof. constructor; unfold gentle_, hardest, unheld, switching; cbn; try lra. apply Rle_trans with 4; [lra | apply Rmax_r]. Qed.

(* The second one comes from far, at 4.6 m/s, and brakes; the first one stands half a metre before the lane. *)
Definition merging : zone := {|
  s_in := 50; s_out := 1000; t_in := 1 / 2; t_out := 1000; lead_from := 34; lead_to := 1000; lane := true |}.
Definition mirror : zone := {|
  s_in := 1 / 2; s_out := 1000; t_in := 50; t_out := 1000; lead_from := -1000; lead_to := -34; lane := true |}.

(** * The second one *)

Notation v2 := (braked (23 / 5) (1 / 10)).
Definition s2 (u : R) := RInt v2 1 u.

Lemma moves2 : motion s2 v2. Proof. apply braked_moves. Qed.

Lemma v2_is u : 1 <= u <= 47 -> v2 u = 23 / 5 + - (1 / 10) * (u - 1).
Proof. intros. unfold braked. cases; lra. Qed.

Lemma s2_is u : 1 <= u <= 47 -> s2 u = 23 / 5 * (u - 1) + - (1 / 10) * (u - 1) * (u - 1) / 2.
Proof.
  intros h. assert (a : s2 1 = 0) by apply (RInt_point 1 v2).
  pose proof (above_line s2 v2 (23 / 5) (- (1 / 10)) 1 u moves2 ltac:(lra)) as A.
  pose proof (below_line s2 v2 (23 / 5) (- (1 / 10)) 1 u moves2 ltac:(lra)) as B.
  specialize (A ltac:(intros; rewrite v2_is; lra)). specialize (B ltac:(intros; rewrite v2_is; lra)). lra.
Qed.

(** * The first one *)

(* At rest until call 7, which commands 1 m/s²; it brakes from call 8 on. *)
Definition v1 (u : R) := Rmax 0 (Rmin (u - 7) (1 - (u - 8) / 10)).
Definition s1 (u : R) := RInt v1 1 u.
Arguments v1 : simpl never.
Definition c1 (i : nat) : R := if Nat.eqb i 7 then 1 else - (1 / 10).
Definition log1 : log := {|
  ego_at i := {| own_s := s1 (INR i); own_v := v1 (INR i); own_least := s1 (INR i) |};
  previous_least i := c1 (i - 1); previous_most i := c1 (i - 1); goes _ := O |}.

Lemma moves1 : motion s1 v1.
Proof.
  apply moves_by; [| intros; apply Rmax_l]. intros x.
  apply (continuous_positive (fun u => Rmin (u - 7) (1 - (u - 8) / 10))).
  apply (continuous_ext (fun u => (u - 7) - Rmax 0 ((u - 7) - (1 - (u - 8) / 10)))).
  { intros u. symmetry. apply Rmin_via_max. }
  apply (continuous_minus (fun u => u - 7) (fun u => Rmax 0 ((u - 7) - (1 - (u - 8) / 10)))).
  - apply (ex_derive_continuous (fun u => u - 7)). auto_derive. trivial.
  - apply continuous_positive. apply (ex_derive_continuous (fun u => (u - 7) - (1 - (u - 8) / 10))). auto_derive. trivial.
Qed.

Lemma v1_rests u : u <= 7 -> v1 u = 0. Proof. intros. unfold v1. cases; lra. Qed.
Lemma v1_goes u : 7 <= u <= 8 -> v1 u = u - 7. Proof. intros. unfold v1. cases; lra. Qed.
Lemma v1_brakes u : 8 <= u -> v1 u = Rmax 0 (1 - (u - 8) / 10). Proof. intros. unfold v1. cases; lra. Qed.

Lemma s1_rests u : 1 <= u <= 7 -> s1 u = 0.
Proof.
  intros h. assert (a : s1 1 = 0) by apply (RInt_point 1 v1).
  pose proof (advances s1 v1 1 u moves1 ltac:(lra)).
  pose proof (below_line s1 v1 0 0 1 u moves1 ltac:(lra)) as B. specialize (B ltac:(intros; rewrite v1_rests; lra)). lra.
Qed.

Lemma c1_goes : c1 7 = 1. Proof. reflexivity. Qed.
Lemma c1_brakes i : i <> 7%nat -> c1 i = - (1 / 10).
Proof. intros h. unfold c1. replace (Nat.eqb i 7) with false by (symmetry; apply Nat.eqb_neq; exact h). reflexivity. Qed.

Lemma obeys1 : obeys gentle_ v1 INR c1.
Proof.
  pose proof (forwards s1 v1 moves1) as pos.
  assert (up : forall a x, speeds_up_at_most v1 a x (x + 0)) by (intros a x; apply (at_most_point v1 pos); lra).
  assert (down : forall a cap x, speeds_up_at_least v1 a cap x (x + 0)) by (intros a cap x; apply at_least_point; lra).
  assert (when : forall i, (S i < 7)%nat /\ INR (S (S i)) <= 7 \/ S i = 7%nat /\ INR (S i) = 7 /\ INR (S (S i)) = 8 \/
            (7 < S i)%nat /\ 8 <= INR (S i)).
  { intros i. destruct (lt_eq_lt_dec (S i) 7) as [[h | h] | h].
    - left. split; [exact h |]. replace 7 with (INR 7) by (simpl; lra). apply le_INR. lia.
    - right; left. rewrite h. split; [reflexivity |]. simpl. lra.
    - do 2 right. split; [exact h |]. replace 8 with (INR 8) by (simpl; lra). apply le_INR. lia. }
  constructor; intros i.
  - cbn. destruct (Nat.eq_dec i 7) as [-> | ne]; [rewrite c1_goes | rewrite c1_brakes by exact ne]; lra.
  - apply up.
  - cbn [latency gentle_]. destruct (when i) as [[h e] | [(h & e & e') | [h e]]].
    + rewrite c1_brakes by lia. intros x x' ? ? ?. rewrite !v1_rests by lra. cases; lra.
    + rewrite h, c1_goes. rewrite h in e, e'. intros x x' ? ? ?. rewrite !v1_goes by lra. cases; lra.
    + rewrite c1_brakes by lia. intros x x' ? ? ?. rewrite !v1_brakes by lra. cases; lra.
  - apply down.
  - cbn [latency gentle_]. destruct (when i) as [[h e] | [(h & e & e') | [h e]]].
    + rewrite c1_brakes by lia. intros x x' ? ? ?. rewrite !v1_rests by lra. apply Rle_trans with (1 := Rmin_l _ _). lra.
    + rewrite h, c1_goes. rewrite h in e, e'. intros x x' ? ? ?. rewrite !v1_goes by lra. apply Rle_trans with (1 := Rmin_l _ _). lra.
    + rewrite c1_brakes by lia. intros x x' ? ? ?. rewrite !v1_brakes by lra. apply Rle_trans with (1 := Rmin_l _ _). cases; lra.
Qed.

(* It carries on but at call 7. *)
Lemma carried1 i : S i <> 7%nat -> carries_on gentle_ log1 c1 i.
Proof. intros h. split; [rewrite c1_brakes by exact h |]; reflexivity. Qed.

(** * What they see *)

Definition view1 (i : nat) := sensed gentle_ (s2 (INR i)) (v2 (INR i)).
Definition view2 (i : nat) := sensed gentle_ (s1 (INR i)) (v1 (INR i)).
Definition log2 := world_log gentle_ s2 v2.
Definition c2 := world_commands gentle_.

Lemma call_ i : (1 <= i)%nat -> 1 <= INR i.
Proof. intros h. change 1 with (INR 1). apply le_INR, h. Qed.

Lemma watches1 (judges : nat -> Prop) : (forall i, (1 <= i)%nat -> judges i) -> watches gentle_ judges s1 v1 s2 v2 INR c1 log1 view1 1.
Proof.
  intros J. constructor; [| exact obeys1 | | | | lia | exact J].
  - exists 0. intros i. cbn. lra.
  - intros i. pose proof (commanded _ _ _ _ obeys1 i) as [_ C]. revert C. unfold own_holds. cbn -[INR c1 Nat.sub s1].
    replace (S i - 1)%nat with i by lia. lra.
  - change (INR 1) with 1. split; intros u x x' ? ? ?; cbn [other_acceleration other_max_speed other_braking gentle_]; unfold braked; cases; lra.
  - change (INR 1) with 1. intros i h. pose proof (call_ i h). apply seen; cbn -[INR s2 braked]; lra.
Qed.

Lemma watches2 (judges : nat -> Prop) : (forall i, (1 <= i)%nat -> judges i) -> watches gentle_ judges s2 v2 s1 v1 INR c2 log2 view2 1.
Proof.
  intros J. constructor; [| | | | | lia | exact J].
  - exists 0. intros i. cbn. lra.
  - apply world_obeys; try reflexivity; [split; reflexivity | cbn; lra |].
    intros x x' ? ?. apply braked_brakes; cbn; lra.
  - intros i. unfold own_holds, log2, world_log, c2, world_commands. cbn -[INR s2 braked]. lra.
  - change (INR 1) with 1. split; intros u x x' ? ? ?; cbn [other_acceleration other_max_speed other_braking gentle_]; unfold v1; cases; lra.
  - change (INR 1) with 1. intros i h. pose proof (call_ i h). apply seen; cbn -[INR s1]; lra.
Qed.

(* The second one counts on precedence from call 1 on. *)
Lemma opened2 : opened_in_lane gentle_ log2 view2 merging (fun i => i = 1%nat) 0 1.
Proof.
  assert (a : s2 1 = 0) by apply (RInt_point 1 v2). pose proof (s1_rests 1 ltac:(lra)) as e. pose proof (v1_rests 1 ltac:(lra)) as e'.
  split; [reflexivity |]. split.
  - change (0 <= s2 1). rewrite a. lra.
  - unfold view2, rest_of, sensed, start. cbn -[s1]. rewrite e, e'. cases; lra.
Qed.

Lemma relies2 i : (1 <= i)%nat -> in_force gentle_ log2 c2 1 (opened_in_lane gentle_ log2 view2 merging (fun i => i = 1%nat) 0) i.
Proof. intros h. exists 1%nat. split; [lia |]. split; [exact opened2 |]. intros j _. apply (world_carries gentle_ s2 v2). Qed.

Lemma cap_is : unlimited gentle_ = 9. Proof. unfold unlimited, gentle_, switching. cbn. lra. Qed.

(* The first one stays before the lane up to call 6, and enters it ahead of the second one by the plan of call 7. *)
Lemma rests1 : stops gentle_ (departs_at gentle_ log1 c1 1) (goes log1 1) (stop_limit gentle_ mirror (ego_at log1 1)).
Proof.
  pose proof (s1_rests 1 ltac:(lra)) as e. pose proof (v1_rests 1 ltac:(lra)) as e'.
  unfold stops, stops_short, stop_limit, rests, departs_at. rewrite departure_is. cbn zeta.
  unfold rest_of, at_most, start, shortest_period, switching, gentle_, log1, c1, mirror. cbn -[s1]. rewrite e, e'. cases; lra.
Qed.

Lemma enters1 : enters_at gentle_ log1 c1 view1 mirror 7.
Proof.
  assert (i7 : INR 7 = 7) by (simpl; lra).
  pose proof (s1_rests 7 ltac:(lra)) as e. pose proof (v1_rests 7 ltac:(lra)) as e'.
  pose proof (s2_is 7 ltac:(lra)) as f. pose proof (v2_is 7 ltac:(lra)) as f'.
  assert (L : least (departs_at gentle_ log1 c1 7) = {| distance := 1 / 2; speed := 1 |}).
  { unfold departs_at. rewrite departure_is. cbn zeta. cbn [least]. rewrite cap_is.
    unfold log1. cbn [own_v ego_at previous_least previous_most]. rewrite i7, e', c1_goes, c1_brakes by lia.
    unfold at_least, start, shortest_period, switching, gentle_. cbn. evaluate. f_equal; lra. }
  split; [reflexivity |]. unfold enters.
  replace (s_in mirror - own_s (ego_at log1 7) + 3 * position_error gentle_) with (1 / 2)
    by (unfold log1; cbn [own_s ego_at]; rewrite i7, e; cbn; lra).
  assert (C : clearing gentle_ (least (departs_at gentle_ log1 c1 7)) (1 / 2) = (1, 1)).
  { rewrite clearing_is, L, cap_is. unfold until, shortest_period, switching, gentle_. cbn [fst snd distance speed ego_go period jitter latency].
    rewrite (Rmax_left (1 / 2 - 1 / 2) 0) by lra. rewrite (Rmax_left 9 1) by lra. rewrite (Rmin_left (1 / 2 - 1 / 2)) by lra.
    replace (1 * 1 + (1 + 1) * (1 / 2 - 1 / 2)) with (1 * 1) by lra. rewrite sqrt_square by lra.
    rewrite (Rmax_right (1 - 1) 0) by lra. rewrite (Rmax_right (1 / 2 - 1 / 2 - _) 0) by lra. f_equal; lra. }
  assert (R : rush gentle_ (w_most (view1 7)) 1 = {| distance := 9 / 2; speed := 5 |}).
  { rewrite rush_is. unfold view1. rewrite i7, f'. unfold rushing, start, sensed, gentle_. cbn. evaluate. f_equal; lra. }
  assert (G : safe_gap gentle_ 5 1 = 3).
  { rewrite safe_gap_is, rush_is. unfold rest_of, rushing, start, gentle_, hardest. cbn. evaluate. lra. }
  unfold in_time. rewrite C. cbv beta iota zeta. rewrite R. cbn [speed fst]. rewrite G.
  split; [change (goes log1 7) with O; unfold shortest_period, gentle_; cbn [INR period jitter]; lra |].
  unfold enters_ahead, gap_ahead, view1, log1. cbn [own_least ego_at]. rewrite i7, e, f.
  unfold sensed, gentle_, mirror. cbn. cases; lra.
Qed.

(* Its plans are those of the calls 1 and 7. *)
Lemma in_force1 (checked : nat -> Prop) i : checked 1%nat -> checked 7%nat -> (1 <= i)%nat -> in_force gentle_ log1 c1 1 checked i.
Proof.
  intros at1 at7 h. destruct (le_lt_dec 7 i) as [late | early]; [exists 7%nat | exists 1%nat].
  all: split; [lia |]; split; [assumption |]; intros j hj; apply carried1; lia.
Qed.

Lemma in_lane_together : inside merging (s2 20) (s1 20).
Proof.
  pose proof (s2_is 20 ltac:(lra)) as f. pose proof (s1_rests 7 ltac:(lra)) as e.
  pose proof (above_line s1 v1 0 1 7 8 moves1 ltac:(lra)) as A. specialize (A ltac:(intros; rewrite v1_goes; lra)).
  pose proof (above_line s1 v1 1 (- (1 / 10)) 8 9 moves1 ltac:(lra)) as B.
  specialize (B ltac:(intros u h; rewrite v1_brakes by lra; cases; lra)).
  pose proof (advances s1 v1 9 20 moves1 ltac:(lra)).
  pose proof (below_line s1 v1 1 0 7 20 moves1 ltac:(lra)) as C.
  specialize (C ltac:(intros u h; unfold v1; cases; lra)).
  unfold inside, merging. cbn [s_in s_out t_in t_out lead_from lead_to]. lra.
Qed.

Lemma before_both : s2 (Rmax (INR 1) (INR 1)) < s_in merging /\ s1 (Rmax (INR 1) (INR 1)) < t_in merging.
Proof.
  rewrite Rmax_left by apply Rle_refl. change (INR 1) with 1.
  pose proof (s2_is 1 ltac:(lra)) as a. pose proof (s1_rests 1 ltac:(lra)) as b. rewrite a, b. cbn. lra.
Qed.

Lemma merging_mirrored : mirrored merging mirror.
Proof. unfold mirrored. cbn. lra. Qed.

(* P7: the first one has the newer claim. *)
Theorem P7_is_needed : ~ Lane_guarantee (fun _ _ => True) judged_in_lane.
Proof.
  intros guaranteed. destruct before_both as [out2 out1].
  refine (guaranteed gentle_ 4 merging mirror s2 v2 s1 v1 0 0 (fun i => i = 1%nat) INR c2 log2 view2 1%nat
    (fun i => i = 7%nat) INR c1 log1 view1 1%nat gentle_valid _ _ I eq_refl eq_refl merging_mirrored _ moves2 moves1 _ _ _ out2 out1
    20 _ in_lane_together).
  - cbn. lra.
  - unfold unheld, switching. cbn. lra.
  - cbn. lra.
  - apply watches2. intros i h. do 3 right. exact (relies2 i h).
  - apply watches1. intros i h. do 2 right; left. apply in_force1; [left; exact rests1 | | exact h].
    do 2 right. split; [exact enters1 | left; reflexivity].
  - intros i j -> ->. right. exists 7, 7.
    assert (v2 7 = 4) by (rewrite v2_is; lra). replace (INR 7) with 7 by (simpl; lra). replace (INR 2) with 2 by (simpl; lra).
    unfold switching. cbn [latency jitter ego_go gentle_]. lra.
  - rewrite Rmax_left by apply Rle_refl. change (INR 1) with 1. lra.
Qed.

(* D8 and D13 in lanes: the first one does not claim, and enters although the second one has arrived. *)
Theorem arrivals_are_needed :
  ~ Lane_guarantee creeps_behind (fun k l c b z claimed since _ _ i => judged k l c b z claimed since i).
Proof.
  intros guaranteed. destruct before_both as [out2 out1].
  refine (guaranteed gentle_ 0 merging mirror s2 v2 s1 v1 0 0 (fun i => i = 1%nat) INR c2 log2 view2 1%nat
    (fun _ => False) INR c1 log1 view1 1%nat gentle_valid _ _ _ eq_refl eq_refl merging_mirrored _ moves2 moves1 _ _ _ out2 out1
    20 _ in_lane_together).
  - cbn. lra.
  - unfold unheld, switching. cbn. lra.
  - unfold creeps_behind. cbn. lra.
  - cbn. lra.
  - apply watches2. intros i h. do 3 right. destruct (relies2 i h) as (i0 & r & (cl & _ & stop) & carried).
    exists i0. split; [exact r |]. split; [| exact carried]. split; [exact cl |]. cbn in stop |- *. lra.
  - apply watches1. intros i h. do 2 right; left. apply in_force1; [left; exact rests1 | | exact h].
    right; right. apply enters1.
  - intros i j _ [].
  - rewrite Rmax_left by apply Rle_refl. change (INR 1) with 1. lra.
Qed.
