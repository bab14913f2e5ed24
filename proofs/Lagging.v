(* The conditions of Theorem 1 for a drivetrain do not contradict each other: an ego whose commands act up to two periods late,
   with a lag and an error, rests before a crossing. *)
Require Import Reals Lra Lia Psatz List.
From Coquelicot Require Import Coquelicot.
Require Import Contract Shipped Motion Reach Lag Drive Departs Clears Driven Drivetrain Statement Ego Shield Controls.
Import ListNotations.
Open Scope R_scope.

Definition slow_ : drivetrain := {|
  exact := {|
    period := 1; latency := 2; jitter := 0; position_error := 0; speed_error := 0; slack := 1 / 100;
    ego_max_speed := 100; ego_acceleration := 1; ego_go := 1; ego_braking := 2;
    other_max_speed := 100; other_acceleration := 2; other_braking := 4;
    follower_reaction := 1; follower_braking := 3; precedence_braking := 1 |};
  ego_emergency := 2; ego_lag := 1; ego_gain := 1 / 4; ego_disturbance := 1 / 4 |}.

Lemma brakes_most : strongest slow_ (- (2)) = - (5 / 4).
Proof. unfold strongest, slow_. cbn. rewrite Rmax_right by lra. lra. Qed.
Lemma brakes_least : weakest slow_ (- (2)) = - (11 / 4).
Proof. unfold weakest, slow_. cbn. rewrite Rmax_right by lra. lra. Qed.

Lemma slow_valid : valid_driven slow_.
Proof.
  constructor; unfold drivable, weakest, unlimited_driven, shortest_period, response, switching, slow_; cbn; evaluate; try lra.
  constructor; unfold bounding, strongest, hardest, unheld, switching; cbn; evaluate; lra.
Qed.

Definition ahead_ : zone := {|
  s_in := 10; s_out := 20; t_in := 10; t_out := 20; lead_from := -100; lead_to := 100; lane := false |}.

(* It brakes for ever; what it would be without rest is slower and slower. *)
Definition pull (u : R) := - (2) * u.
Definition x (u : R) := - (2) * u + 2.
Definition c (_ : nat) := - (2).
Definition ego (_ : nat) : own := {| own_s := 0; own_v := 0; own_least := 0 |}.
Definition view (_ : nat) := sensed (bounding slow_) 0 0.
Definition parts : list part := [
  {| lasts := 1; low := - (11 / 4); high := - (5 / 4); later := false |};
  {| lasts := 2; low := - (11 / 4); high := - (5 / 4); later := true |}].

Lemma on_grid_ : on_grid slow_ INR.
Proof. exists 0. intros i. cbn. lra. Qed.

Lemma a_call t : INR 1 <= t -> exists j, INR j <= t <= INR (S j).
Proof.
  intros h. destruct (between slow_ INR 1 t) as (j & _ & hj); [cbn; lra | exact on_grid_ | apply le_INR; lia | exact h |].
  exists j. exact hj.
Qed.

Lemma ego_drives_ : drives slow_ 1 (fun _ => 0) x pull INR c.
Proof.
  constructor.
  - constructor; [lra | lra |]. intros _ t. unfold x, pull. auto_derive; [trivial | field].
  - cbn. lra.
  - intros t t' q lo le every. destruct (Req_dec t t') as [-> | ne]; [lra |]. destruct (a_call t lo) as (j & h1 & h2).
    pose proof (every j ltac:(lra) ltac:(cbn [latency exact slow_]; lra)) as Q. unfold c in Q. rewrite brakes_most in Q.
    unfold pull. assert (- (2) * (t' - t) <= q * (t' - t)) by (apply Rmult_le_compat_r; lra). lra.
  - intros t t' q lo le every. destruct (Req_dec t t') as [-> | ne]; [lra |]. destruct (a_call t lo) as (j & h1 & h2).
    pose proof (every j ltac:(lra) ltac:(cbn [latency exact slow_]; lra)) as Q. unfold c in Q. rewrite brakes_least in Q.
    unfold pull. assert (q * (t' - t) <= - (2) * (t' - t)) by (apply Rmult_le_compat_r; lra). lra.
  - intros t t' le. unfold x, pull. destruct (Req_dec t t') as [-> | ne]; [left; lra | right]. exists t'. repeat split; lra.
Qed.

Lemma ego_held_ : goes_with (fun _ => - 0) (fun u => - x u) (fun u => - pull u) (- unlimited_driven slow_).
Proof. intros t t' le. left. unfold x. lra. Qed.

Lemma carried_ count : carried slow_ 1 (fun _ => 0) (fun _ => 0) x pull INR c 0 0 count 0 parts true.
Proof.
  destruct slow_valid as [_ dr _ g _ _ cap]. constructor.
  - auto.
  - apply (rest_moves 0).
  - exact ego_drives_.
  - exact ego_held_.
  - exact on_grid_.
  - assert (commands : - (11 / 4) <= weakest slow_ (- (2)) /\ strongest slow_ (- (2)) <= - (5 / 4))
      by (rewrite brakes_most, brakes_least; lra).
    assert (rs : response slow_ = 3) by (unfold response, switching, slow_; cbn; lra).
    assert (sp : shortest_period slow_ = 1) by (unfold shortest_period, slow_; cbn; lra).
    cbn -[shortest_period response weakest strongest slow_ x pull INR]. rewrite rs, sp.
    repeat split; try lra; try (intros; apply commands); try discriminate; try (intros; unfold x, pull; lra); intros; cbn in *; exfalso; lra.
  - unfold shortest_period, response, switching, slow_. cbn. lra.
  - cbn. lra.
  - cbn. unfold c. lra.
  - intros. lia.
  - intros. reflexivity.
Qed.

Theorem a_drivetrain_can_meet_them :
  conditions slow_ 1 (fun _ => 0) (fun _ => 0) x pull INR c ego (fun _ => 0) (fun _ => 0) view ahead_ (fun _ => False) 1 /\
  forall i, (1 <= i)%nat -> judged_driven slow_ 1 (fun _ => 0) (fun _ => 0) x pull INR c ego view ahead_ (fun _ => False) 1 i.
Proof.
  split.
  - constructor; try (intros; discriminate); [constructor |].
    + exact slow_valid.
    + apply (rest_moves 0).
    + exact ego_drives_.
    + exact ego_held_.
    + exact on_grid_.
    + intros i. unfold c. cbn. lra.
    + intros i _. unfold own_holds. cbn. lra.
    + change (strongest slow_ (ego_braking slow_)) with (strongest slow_ 2). unfold strongest, x, pull. cbn. evaluate. lra.
    + apply (rest_moves 0).
    + split; intros u p q ? ? ?; cbn; cases; lra.
    + intros i h. apply seen; cbn -[INR]; try lra. apply le_INR. exact h.
    + lia.
    + intros j i _ [].
  - intros i h. do 2 right; left. exists 0%nat, (i - 1)%nat, 0%nat, parts, true.
    split; [lia |]. split; [lia |]. split; [exact (carried_ (i - 1)) |]. left.
    unfold stops_driven, stops_short, stop_limit, rests_driven, departure_driven, parts. cbn [braking fold_left lasts low high].
    change (c 1) with (- (2)). rewrite brakes_most. unfold at_most, rest_of, start, shortest_period, bounding, slow_, ego, ahead_.
    cbn. evaluate. lra.
Qed.
