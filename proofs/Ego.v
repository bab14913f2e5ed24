(* (i) The ego under a plan: its commands, when they take effect, and how fast it is where go is reduced. *)
Require Import Reals Lra Lia Psatz List.
Require Import Contract Shipped Motion Reach Statement.
Open Scope R_scope.

(** * What the printed functions are *)

(* The departure is three steps, each of the bound that the proof is about. *)
Lemma departure_is k sensed pl pm a :
  let most2 := at_most (at_most (start (sensed + speed_error k)) (Rmax pm a) (switching k)) a
                 (shortest_period k - switching k) in
  let least2 := at_least (at_least (start (sensed - speed_error k)) (Rmin pl a) (unlimited k) (switching k)) a
                  (unlimited k) (shortest_period k - switching k) in
  departure k sensed pl pm a = {|
    braking := at_most most2 a (switching k);
    most := at_most most2 (Rmax a (ego_go k)) (switching k);
    least := at_least least2 (Rmin a (ego_go k)) (unlimited k) (switching k) |}.
Proof. reflexivity. Qed.

Lemma clearing_is k r target :
  clearing k r target =
    (fst (until r target (ego_go k) (unlimited k)) + shortest_period k + switching k,
     snd (until r target (ego_go k) (unlimited k))).
Proof. reflexivity. Qed.

Lemma rest_is k r time : rest k r time = rest_of (at_most r (ego_go k) time) (ego_braking k).
Proof. reflexivity. Qed.

Lemma rush_is k v time : rush k v time = rushing (start v) (other_acceleration k) (other_max_speed k) time.
Proof. reflexivity. Qed.

Lemma dawdle_is k v time : dawdle k v time = at_least (start v) (- other_braking k) 0 time.
Proof. reflexivity. Qed.

Lemma safe_gap_is k w v :
  safe_gap k w v =
    Rmax (rest_of (rush k w (follower_reaction k)) (follower_braking k) - rest_of (start v) (hardest k)) 0.
Proof. reflexivity. Qed.

Lemma earliest_rest_is k w : earliest_rest k w = rest_of (start w) (other_braking k).
Proof. reflexivity. Qed.

Lemma unlimited_is k : unlimited k = unheld k.
Proof. reflexivity. Qed.

(** * A reduced go *)

Lemma below_quotient x y d : 0 < d -> x * d <= y -> x <= y / d.
Proof. intros. apply Rmult_le_reg_r with d; [lra |]. field_simplify; lra. Qed.

(* An ego that may not go as planned is fast: even if it brakes until its command takes effect it stays above [unheld]. *)
Definition fast k v := unheld k + ego_braking k * switching k <= v.

(* L31: an ego that is not may go. *)
Lemma may_go k v sensed in_effect :
  valid k -> sensed <= v + speed_error k -> in_effect <= ego_acceleration k ->
  ego_go k <= most_command k sensed in_effect \/ fast k v.
Proof.
  intros ok se ie. unfold fast.
  destruct (Rle_dec (unheld k + ego_braking k * switching k) v) as [f | slow]; [right; exact f | left].
  destruct ok. unfold most_command, unheld in *.
  assert (sw : 0 <= switching k) by (unfold switching; lra).
  assert (E : Rmax 0 in_effect <= ego_acceleration k) by (cases; lra).
  assert (Rmax 0 in_effect * switching k <= ego_acceleration k * switching k) by (apply Rmult_le_compat_r; lra).
  assert (ego_go k * switching k <= ego_acceleration k * switching k) by (apply Rmult_le_compat_r; lra).
  apply Rmin_glb; [| lra]. apply Rle_trans with (2 := Rmax_r _ _).
  apply Rmin_glb; apply below_quotient; lra.
Qed.

(** * Which command is in effect *)

Section Commands.
Variables (k : contract) (v : R -> R) (tau c : nat -> R).
Hypothesis ok : valid k.
Hypothesis nonneg : forall t, 0 <= v t.
Hypothesis grid : on_grid k tau.
Hypothesis obey : obeys k v tau c.

Lemma spacing i m :
  tau i + INR m * period k - 2 * jitter k <= tau (i + m)%nat <= tau i + INR m * period k + 2 * jitter k.
Proof.
  destruct grid as [g G]. pose proof (G i). pose proof (G (i + m)%nat) as G'. rewrite plus_INR in G'. lra.
Qed.

Lemma latency_fits i : tau i + latency k <= tau (S i).
Proof.
  pose proof (spacing i 1) as H. replace (i + 1)%nat with (S i) in H by lia. simpl INR in H.
  destruct ok. lra.
Qed.

Lemma calls_ordered i j : (i <= j)%nat -> tau i <= tau j.
Proof.
  induction 1; [lra |]. pose proof (latency_fits m). destruct ok. lra.
Qed.

Lemma at_most_point a t1 t2 : t2 <= t1 -> speeds_up_at_most v a t1 t2.
Proof.
  intros e t t' ? ? ?. replace (t' - t) with 0 by lra. assert (t' = t) by lra. subst.
  pose proof (nonneg t). cases; lra.
Qed.

Lemma at_least_point a cap t1 t2 : t2 <= t1 -> speeds_up_at_least v a cap t1 t2.
Proof.
  intros e t t' ? ? ?. replace (t' - t) with 0 by lra. assert (t' = t) by lra. subst.
  apply Rle_trans with (v t + a * 0); [apply Rmin_l | lra].
Qed.

Lemma at_least_join a cap t1 t2 t3 :
  speeds_up_at_least v a cap t1 t2 -> speeds_up_at_least v a cap t2 t3 -> speeds_up_at_least v a cap t1 t3.
Proof.
  intros H1 H2 t t' lo le hi.
  destruct (Rle_dec t' t2); [apply H1; lra |].
  destruct (Rle_dec t2 t); [apply H2; lra |].
  pose proof (H1 t t2 ltac:(lra) ltac:(lra) ltac:(lra)) as A.
  pose proof (H2 t2 t' ltac:(lra) ltac:(lra) ltac:(lra)) as B.
  assert (D : a * (t' - t) = a * (t2 - t) + a * (t' - t2)) by ring.
  destruct (Rle_dec 0 a).
  - assert (0 <= a * (t2 - t)) by nra. assert (0 <= a * (t' - t2)) by nra.
    revert A B. cases; lra.
  - assert (a * (t2 - t) <= 0) by nra. assert (a * (t' - t2) <= 0) by nra.
    revert A B. cases; lra.
Qed.

(* The command of a call may be in effect from the call until the latency after the next one. *)
Definition in_effect (t1 t2 : R) (j : nat) := tau j < t2 /\ t1 < tau (S j) + latency k.

Lemma one_period_up j a t1 t2 :
  tau (S j) <= t1 -> t2 <= tau (S (S j)) -> (forall q, (j <= q <= S j)%nat -> in_effect t1 t2 q -> c q <= a) ->
  speeds_up_at_most v a t1 t2.
Proof.
  intros lo hi below.
  destruct (Rle_dec t2 t1); [apply at_most_point; lra |].
  pose proof (latency_fits j). pose proof (latency_fits (S j)). destruct ok.
  assert (c (S j) <= a) by (apply below; [lia | split; lra]).
  assert (second : forall t, tau (S j) + latency k <= t -> speeds_up_at_most v a t t2).
  { intros. apply at_most_weaken with (c (S j)); [assumption |].
    apply at_most_within with (3 := stays_up k v tau c obey j); lra. }
  destruct (Rle_dec (tau (S j) + latency k) t1); [auto |].
  assert (c j <= a) by (apply below; [lia | split; lra]).
  assert (first : forall t, t <= tau (S j) + latency k -> speeds_up_at_most v a t1 t).
  { intros. apply at_most_weaken with (Rmax (c j) (c (S j))); [cases; lra |].
    apply at_most_within with (3 := switches_up k v tau c obey j); lra. }
  destruct (Rle_dec t2 (tau (S j) + latency k)); [auto |].
  apply at_most_join with (tau (S j) + latency k); auto; [apply first | apply second]; lra.
Qed.

(* Command j is a or more; or it is reduced, and given to an ego that is fast. *)
Definition enough (a : R) (j : nat) := a <= c j \/ 0 <= c j /\ exists i, j = S i /\ fast k (v (tau j)).

(* One that is fast loses little until its command takes effect. *)
Lemma fast_at_first i t :
  0 <= c (S i) -> fast k (v (tau (S i))) -> tau (S i) <= t <= tau (S i) + latency k -> unheld k <= v t.
Proof.
  intros c0 f [lo hi]. unfold fast in f. pose proof (commanded k v tau c obey i) as cm.
  pose proof (switches_down k v tau c obey i (tau (S i)) t ltac:(lra) ltac:(lra) ltac:(lra)) as U.
  destruct ok.
  assert (ego_braking k * (t - tau (S i)) <= ego_braking k * switching k).
  { apply Rmult_le_compat_l; [lra | unfold switching; lra]. }
  assert (- ego_braking k * (t - tau (S i)) <= Rmin (c i) (c (S i)) * (t - tau (S i))).
  { apply Rmult_le_compat_r; [lra | apply Rmin_glb; lra]. }
  assert (0 <= ego_braking k * switching k) by (apply Rmult_le_pos; [| unfold switching]; lra).
  set (change := Rmin (c i) (c (S i)) * (t - tau (S i))) in *. revert U. cases; lra.
Qed.

(* Who does not brake stays as fast as it is. *)
Lemma stays_fast a t1 t2 t :
  0 <= a -> speeds_up_at_least v a (unheld k) t1 t2 -> unheld k <= v t1 -> t1 <= t <= t2 -> unheld k <= v t.
Proof.
  intros a0 up f [lo hi]. pose proof (up t1 t ltac:(lra) ltac:(lra) ltac:(lra)) as U.
  assert (0 <= a * (t - t1)) by (apply Rmult_le_pos; lra). revert U. cases; lra.
Qed.

Lemma fast_until_next i t :
  0 <= c (S i) -> fast k (v (tau (S i))) -> tau (S i) <= t <= tau (S (S i)) -> unheld k <= v t.
Proof.
  intros c0 f [lo hi]. destruct (Rle_dec t (tau (S i) + latency k)) as [first | second].
  - apply fast_at_first with i; auto.
  - apply (stays_fast (c (S i)) (tau (S i) + latency k) (tau (S (S i)))); [exact c0 | | | lra].
    + apply (stays_down k v tau c obey i).
    + apply fast_at_first with i; auto. destruct ok. lra.
Qed.

(* One that is fast may do without accelerating. *)
Lemma at_least_fast a b t1 t2 :
  0 <= b -> speeds_up_at_least v b (unheld k) t1 t2 -> (forall t, t1 <= t <= t2 -> unheld k <= v t) ->
  speeds_up_at_least v a (unheld k) t1 t2.
Proof.
  intros b0 up f t t' ? ? ?. pose proof (up t t' ltac:(lra) ltac:(lra) ltac:(lra)) as U. pose proof (f t ltac:(lra)).
  assert (0 <= b * (t' - t)) by (apply Rmult_le_pos; lra).
  apply Rle_trans with (1 := Rmin_r _ _). revert U. cases; lra.
Qed.

Lemma switches_enough i a :
  enough a i -> enough a (S i) -> speeds_up_at_least v a (unheld k) (tau (S i)) (tau (S i) + latency k).
Proof.
  intros old new. pose proof (switches_down k v tau c obey i) as down.
  assert (lat : 0 <= latency k) by (destruct ok; lra).
  destruct new as [new | [new0 (i' & e & f)]].
  - destruct old as [old | [old0 (i' & -> & f)]].
    + apply at_least_weaken with (Rmin (c i) (c (S i))); [apply Rmin_glb; lra | exact down].
    + destruct (Rle_dec 0 (c (S (S i')))) as [new0 | brakes].
      * apply at_least_fast with (Rmin (c (S i')) (c (S (S i')))); [apply Rmin_glb; lra | exact down |].
        intros t [? ?]. apply (stays_fast (Rmin (c (S i')) (c (S (S i')))) (tau (S (S i'))) (tau (S (S i')) + latency k));
          [apply Rmin_glb; lra | exact down | | lra].
        apply fast_until_next with i'; auto. pose proof (latency_fits (S i')). lra.
      * apply at_least_weaken with (Rmin (c (S i')) (c (S (S i')))); [apply Rmin_glb; lra | exact down].
  - injection e as <-.
    assert (F : forall t, tau (S i) <= t <= tau (S i) + latency k -> unheld k <= v t).
    { intros t h. apply fast_at_first with i; auto. }
    assert (never : 0 <= c i -> speeds_up_at_least v a (unheld k) (tau (S i)) (tau (S i) + latency k)).
    { intros old0. apply at_least_fast with (Rmin (c i) (c (S i))); [apply Rmin_glb; lra | exact down | exact F]. }
    destruct old as [old | [old0 _]]; [| exact (never old0)].
    destruct (Rle_dec 0 (c i)) as [old0 | brakes]; [exact (never old0) |].
    apply at_least_weaken with (Rmin (c i) (c (S i))); [apply Rmin_glb; lra | exact down].
Qed.

Lemma stays_enough i a :
  enough a (S i) -> speeds_up_at_least v a (unheld k) (tau (S i) + latency k) (tau (S (S i))).
Proof.
  intros [new | [new0 (i' & e & f)]]; pose proof (stays_down k v tau c obey i) as down.
  - apply at_least_weaken with (c (S i)); assumption.
  - injection e as <-. apply at_least_fast with (c (S i)); [exact new0 | exact down |].
    intros t [? ?]. apply fast_until_next with i; auto. destruct ok. lra.
Qed.

Lemma one_period_down j a t1 t2 :
  tau (S j) <= t1 -> t2 <= tau (S (S j)) -> (forall q, (j <= q <= S j)%nat -> in_effect t1 t2 q -> enough a q) ->
  speeds_up_at_least v a (unheld k) t1 t2.
Proof.
  intros lo hi above.
  destruct (Rle_dec t2 t1); [apply at_least_point; lra |].
  pose proof (latency_fits j). pose proof (latency_fits (S j)).
  assert (0 <= latency k) by (destruct ok; lra).
  assert (new : enough a (S j)) by (apply above; [lia | split; lra]).
  assert (second : forall t, tau (S j) + latency k <= t -> speeds_up_at_least v a (unheld k) t t2).
  { intros. apply at_least_within with (3 := stays_enough j a new); lra. }
  destruct (Rle_dec (tau (S j) + latency k) t1); [auto |].
  assert (old : enough a j) by (apply above; [lia | split; lra]).
  assert (first : forall t, t <= tau (S j) + latency k -> speeds_up_at_least v a (unheld k) t1 t).
  { intros. apply at_least_within with (3 := switches_enough j a old new); lra. }
  destruct (Rle_dec t2 (tau (S j) + latency k)); [auto |].
  apply at_least_join with (tau (S j) + latency k); auto; [apply first | apply second]; lra.
Qed.

(* A bound on every command that may be in effect bounds the motion. *)
Lemma commands_up i m a t1 t2 :
  tau (S i) <= t1 -> t2 <= tau (S i + m)%nat ->
  (forall j, (i <= j < S i + m)%nat -> in_effect t1 t2 j -> c j <= a) -> speeds_up_at_most v a t1 t2.
Proof.
  revert t2. induction m as [| m IH]; intros t2 lo hi below.
  { rewrite Nat.add_0_r in hi. apply at_most_point. lra. }
  replace (S i + S m)%nat with (S (S (i + m))) in hi by lia.
  set (x := tau (S i + m)%nat) in *.
  assert (X : x = tau (S (i + m))) by reflexivity.
  destruct (Rle_dec t2 x) as [early | late].
  { apply IH; auto. intros j [? ?] e. apply below; [lia | exact e]. }
  destruct (Rle_dec x t1) as [l | e].
  { apply one_period_up with (i + m)%nat; [lra | lra |]. intros q [? ?] eff. apply below; [lia | exact eff]. }
  apply at_most_join with x; auto.
  - apply IH; [lra | lra |]. intros j [? ?] [? ?]. apply below; [lia | split; lra].
  - apply one_period_up with (i + m)%nat; [lra | lra |]. intros q [? ?] [? ?]. apply below; [lia | split; lra].
Qed.

Lemma commands_down i m a t1 t2 :
  tau (S i) <= t1 -> t2 <= tau (S i + m)%nat ->
  (forall j, (i <= j < S i + m)%nat -> in_effect t1 t2 j -> enough a j) -> speeds_up_at_least v a (unheld k) t1 t2.
Proof.
  revert t2. induction m as [| m IH]; intros t2 lo hi above.
  { rewrite Nat.add_0_r in hi. apply at_least_point. lra. }
  replace (S i + S m)%nat with (S (S (i + m))) in hi by lia.
  set (x := tau (S i + m)%nat) in *.
  assert (X : x = tau (S (i + m))) by reflexivity.
  destruct (Rle_dec t2 x) as [early | late].
  { apply IH; auto. intros j [? ?] e. apply above; [lia | exact e]. }
  destruct (Rle_dec x t1) as [l | e].
  { apply one_period_down with (i + m)%nat; [lra | lra |]. intros q [? ?] eff. apply above; [lia | exact eff]. }
  apply at_least_join with x.
  - apply IH; [lra | lra |]. intros j [? ?] [? ?]. apply above; [lia | split; lra].
  - apply one_period_down with (i + m)%nat; [lra | lra |]. intros q [? ?] [? ?]. apply above; [lia | split; lra].
Qed.

(* The ego never brakes harder than b. *)
Lemma ego_brakes_at_most i m t t' :
  tau (S i) <= t -> t <= t' -> t' <= tau (S i + m)%nat -> v t - ego_braking k * (t' - t) <= v t'.
Proof.
  intros lo le hi.
  assert (H : speeds_up_at_least v (- ego_braking k) (unheld k) t t').
  { apply commands_down with i m; auto. intros j _ _. left. apply (commanded k v tau c obey). }
  specialize (H t t' ltac:(lra) le ltac:(lra)).
  assert (0 <= ego_braking k * (t' - t)) by (destruct ok; apply Rmult_le_pos; lra).
  revert H. cases; lra.
Qed.

(** * The intervals of a plan *)

(* (i) 2: the accelerations under a plan of n periods of go, from the call T that verified it to the time E.
   Turns are counted from two jitters before the calls. *)
Record plan_followed (T E pl pm a : R) (n : nat) : Prop := {
  up1 u : T <= u <= E -> u <= T + switching k -> speeds_up_at_most v (Rmax pm a) T u;
  up2 u : T + switching k <= u <= E -> u <= T + shortest_period k -> speeds_up_at_most v a (T + switching k) u;
  up3 u : T + shortest_period k <= u <= E -> u <= T + shortest_period k + switching k ->
    speeds_up_at_most v (match n with O => a | S _ => Rmax a (ego_go k) end) (T + shortest_period k) u;
  up4 u : T + shortest_period k + switching k <= u <= E ->
    u <= T + shortest_period k + switching k + INR n * period k ->
    speeds_up_at_most v (ego_go k) (T + shortest_period k + switching k) u;
  up5 u : T + shortest_period k + switching k + INR n * period k <= u <= E ->
    speeds_up_at_most v (- ego_braking k) (T + shortest_period k + switching k + INR n * period k) u;
  down1 u : T <= u <= E -> u <= T + switching k -> speeds_up_at_least v (Rmin pl a) (unheld k) T u;
  down2 u : T + switching k <= u <= E -> u <= T + shortest_period k ->
    speeds_up_at_least v a (unheld k) (T + switching k) u;
  down3 u : T + shortest_period k <= u <= E -> u <= T + shortest_period k + switching k ->
    u <= T + shortest_period k + INR n * period k ->
    speeds_up_at_least v (Rmin a (ego_go k)) (unheld k) (T + shortest_period k) u;
  down4 u : T + shortest_period k + switching k <= u <= E -> u <= T + shortest_period k + INR n * period k ->
    speeds_up_at_least v (ego_go k) (unheld k) (T + shortest_period k + switching k) u
}.

Lemma switching_fits : 0 <= switching k <= shortest_period k /\ shortest_period k <= period k.
Proof. unfold switching, shortest_period. destruct ok. lra. Qed.

(* From a call on, the plan of a log is followed. *)
Variables (l : log).

Hypothesis knows : forall i,
  own_v (ego_at l (S i)) <= v (tau (S i)) + speed_error k /\ previous_most l (S i) <= ego_acceleration k.

(* An ego that goes is as fast as if its go were not reduced. *)
Lemma going_is_enough a i : a <= ego_go k -> goes_on k l c (S i) -> enough a (S i).
Proof.
  intros ag [lo _]. destruct (knows i) as [se ie]. set (x := own_v _) in *. set (y := previous_most _ _) in *.
  assert (m0 : 0 <= Rmin (ego_go k) (most_command k x y)).
  { apply Rmin_glb; [destruct ok; lra |]. unfold most_command. apply Rmin_glb; [apply Rmax_l | destruct ok; lra]. }
  destruct (may_go k (v (tau (S i))) x y ok se ie) as [may | f].
  - left. rewrite Rmin_left in lo by exact may. lra.
  - right. split; [lra | exists i; auto].
Qed.

Lemma plan_is_followed i m :
  previous_least l (S i) <= c i <= previous_most l (S i) ->
  (forall j, (S i <= j < S i + m)%nat -> carries_on k l c j) ->
  plan_followed (tau (S i)) (tau (S (S i) + m)%nat) (previous_least l (S i)) (previous_most l (S i)) (c (S i))
    (goes l (S i)).
Proof.
  intros prev carried.
  set (T := tau (S i)). set (n := goes l (S i)).
  destruct switching_fits as [[sw0 sw] sp].
  pose proof ok as ok'. destruct ok'.
  (* What the plan commands. *)
  assert (left : forall q, (q <= m)%nat -> goes l (S i + q)%nat = (n - q)%nat).
  { induction q as [| q IH]; intros hq; [rewrite Nat.add_0_r; unfold n; lia |].
    specialize (IH ltac:(lia)). pose proof (carried (S i + q)%nat ltac:(lia)) as C. unfold carries_on in C.
    replace (S i + S q)%nat with (S (S i + q)) by lia.
    rewrite IH in C. destruct (n - q)%nat as [| r] eqn:e; lia. }
  assert (go : forall q, (q < m)%nat -> (q < n)%nat -> goes_on k l c (S (S i + q))).
  { intros q hm hn. pose proof (carried (S i + q)%nat ltac:(lia)) as C. unfold carries_on in C.
    rewrite (left q ltac:(lia)) in C. destruct (n - q)%nat as [| r] eqn:e; [lia | apply C]. }
  assert (brake : forall q, (q < m)%nat -> (n <= q)%nat -> c (S (S i) + q)%nat = - ego_braking k).
  { intros q hm hn. pose proof (carried (S i + q)%nat ltac:(lia)) as C. unfold carries_on in C.
    rewrite (left q ltac:(lia)) in C. replace (n - q)%nat with O in C by lia.
    replace (S (S i) + q)%nat with (S (S i + q)) by lia. apply C. }
  (* When its commands may be in effect. *)
  assert (turn : forall q, T + shortest_period k + INR q * period k <= tau (S (S i) + q)%nat /\
                           tau (S (S i) + q)%nat + latency k <= T + shortest_period k + INR q * period k + switching k).
  { intros q. pose proof (spacing (S i) (S q)) as H. rewrite S_INR in H.
    replace (S i + S q)%nat with (S (S i) + q)%nat in H by lia. fold T in H.
    unfold shortest_period, switching. lra. }
  assert (later : forall p q, (p <= q)%nat -> INR p * period k <= INR q * period k).
  { intros p q h. apply Rmult_le_compat_r; [lra | apply le_INR, h]. }
  assert (a0 : - ego_braking k <= c (S i)) by apply (commanded k v tau c obey).
  (* Command i, command S i, or number q of the commands that follow. *)
  assert (which : forall j, (i <= j < S i + S m)%nat ->
            j = i \/ j = S i \/ exists q, (q < m)%nat /\ j = (S (S i) + q)%nat).
  { intros j h. destruct (Nat.eq_dec j i); [left; assumption |]. destruct (Nat.eq_dec j (S i)); [right; left; assumption |].
    right; right. exists (j - S (S i))%nat. lia. }
  assert (end_ : tau (S (S i) + m)%nat = tau (S i + S m)%nat) by (f_equal; lia).
  pose proof (turn O) as first. rewrite Nat.add_0_r in first. simpl INR in first.
  assert (T1 : forall q, T + shortest_period k + INR q * period k <= tau (S (S i) + q)%nat) by apply turn.
  assert (T2 : forall q, tau (S (S (S i) + q)) + latency k <= T + shortest_period k + (INR q + 1) * period k + switching k).
  { intros q. replace (S (S (S i) + q)) with (S (S i) + S q)%nat by lia. rewrite <- S_INR. apply turn. }
  assert (go_pos : forall q, 0 <= INR q * period k) by (intros; apply Rmult_le_pos; [apply pos_INR | lra]).
  assert (lat : latency k <= switching k) by (unfold switching; lra).
  assert (many : forall q, (1 <= q)%nat -> period k <= INR q * period k).
  { intros q h. pose proof (later 1%nat q h) as L. simpl INR in L. lra. }
  pose proof (go_pos n) as n0. destruct prev as [prev1 prev2].
  clearbody n. clear left carried turn.
  constructor; intros u [lo hi]; intros; rewrite end_ in hi;
    first [apply commands_up with i (S m) | apply commands_down with i (S m)]; try (unfold T in *; lra);
    intros j hj [e1 e2]; destruct (which j hj) as [-> | [-> | (q & hq & ->)]];
    fold T in e1, e2.
  all: try (destruct n; cases; lra).
  all: try (left; cases; lra).
  all: pose proof (T1 q) as Q1; pose proof (T2 q) as Q2; pose proof (go_pos q) as Q3.
  all: destruct (le_lt_dec n q) as [h | h];
    [ pose proof (brake q hq h) as C; pose proof (later n q h) as L
    | pose proof (go q hq h) as C; pose proof (later (S q) n h) as L; rewrite S_INR in L ].
  all: destruct (Nat.eq_dec q 0) as [-> | h1]; [simpl INR in * | pose proof (many q ltac:(lia)) as M].
  all: try (exfalso; lra).
  all: try (rewrite C; destruct n; cases; lra || lia).
  all: try (apply going_is_enough; [cases; lra | exact C]).
  all: destruct C as [_ C]; apply Rle_trans with (1 := C); destruct n; cases; lra || lia.
Qed.
End Commands.
